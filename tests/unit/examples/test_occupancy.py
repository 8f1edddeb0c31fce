"""What is drawn on the grid, and what stays as it was."""

import math

import numpy as np
import pytest

from examples.slam.beams import Beams
from examples.slam.occupancy import OccupancyGrid
from examples.slam.pose import Pose

CELL = 0.05


def one_beam(free, hit=True, angle=0.0):
    return Beams(np.array([angle]), np.array([free]), np.array([free if hit else np.nan]))


@pytest.fixture
def grid():
    return OccupancyGrid(CELL)


def at(grid, x, y):
    """The value of the cell in which a point [m] lies; -1 off the map."""
    drawn = grid.map()
    row, column = math.floor((y - drawn.y) / CELL + 1e-9), math.floor((x - drawn.x) / CELL + 1e-9)
    inside = 0 <= row < drawn.cells.shape[0] and 0 <= column < drawn.cells.shape[1]
    return int(drawn.cells[row, column]) if inside else -1


def test_a_hit_is_occupied_and_the_way_there_is_free(grid):
    grid.draw(one_beam(1.01), Pose(0.01, 0.01, 0.0))
    assert [at(grid, x, 0.01) for x in (0.01, 0.5, 0.96)] == [23, 23, 23]
    assert at(grid, 1.02, 0.01) == 88
    assert [at(grid, 1.07, 0.01), at(grid, 0.5, 0.06), at(grid, -0.04, 0.01)] == [-1, -1, -1]


def test_what_was_not_seen_before_a_hit_stays_unknown(grid):
    grid.draw(Beams(np.zeros(1), np.array([0.51]), np.array([1.01])), Pose(0.01, 0.01, 0.0))
    assert [at(grid, 0.01, 0.01), at(grid, 0.46, 0.01), at(grid, 0.56, 0.01), at(grid, 0.96, 0.01)] == [23, 23, -1, -1]
    assert at(grid, 1.02, 0.01) == 88


def test_a_free_beam_leaves_its_end_unoccupied(grid):
    grid.draw(one_beam(1.01, hit=False), Pose(0.01, 0.01, 0.0))
    assert [at(grid, 1.015, 0.01), at(grid, 1.06, 0.01)] == [23, -1]


def test_a_beam_that_says_nothing_changes_nothing(grid):
    grid.draw(one_beam(0.0, hit=False), Pose())
    assert not grid.map().cells.size
    grid.draw(one_beam(1.0), Pose())
    before = grid.map().cells.copy()
    grid.draw(one_beam(0.0, hit=False), Pose())
    assert (grid.map().cells == before).all()


@pytest.mark.parametrize("heading", np.linspace(-math.pi, math.pi, 9))
def test_beams_go_where_they_point(grid, heading):
    origin = Pose(-3.02, 1.03, heading)
    grid.draw(one_beam(2.0, angle=0.25), origin)
    end = origin.then(Pose(2.0 * math.cos(0.25), 2.0 * math.sin(0.25)))
    assert at(grid, end.x, end.y) == 88
    assert at(grid, (origin.x + end.x) / 2, (origin.y + end.y) / 2) == 23


def test_a_hit_is_not_freed_by_the_beam_beside_it(grid):
    seen = Beams(np.array([0.0, 0.001]), np.array([1.0, 3.0]), np.array([1.0, np.nan]))
    grid.draw(seen, Pose(0.01, 0.02, 0.0))
    assert at(grid, 1.01, 0.02) == 88


def test_nothing_is_freed_too_near_to_be_seen(grid):
    """An edge that was seen from afar stays on the map when the robot stands before it and looks over it."""
    grid.draw(one_beam(2.02), Pose(0.01, 0.01, 0.0), near=0.7)
    for _ in range(20):
        grid.draw(one_beam(3.0, hit=False), Pose(1.51, 0.01, 0.0), near=0.7)
    assert at(grid, 2.03, 0.01) == 88
    assert at(grid, 2.4, 0.01) == 2


def test_a_cell_changes_its_mind(grid):
    for _ in range(50):
        grid.draw(one_beam(1.0), Pose())
    assert at(grid, 1.0, 0.0) == 98
    for _ in range(5):
        grid.draw(one_beam(2.0), Pose())
    assert at(grid, 1.0, 0.0) < 25


def test_the_map_grows_and_keeps_what_was_drawn(grid):
    grid.draw(one_beam(1.0), Pose())
    for place in (Pose(9.0, 0.0), Pose(-9.0, 4.0), Pose(0.0, -7.0)):
        grid.draw(one_beam(1.0), place)
        assert at(grid, place.x + 1.0, place.y) == 88
    assert at(grid, 1.0, 0.0) == 88


def test_a_scan_from_the_end_of_the_world_is_dropped(grid, caplog):
    grid.draw(one_beam(1.0), Pose())
    before = grid.map().cells.shape
    grid.draw(one_beam(1.0), Pose(1e6, 1e6))
    assert grid.map().cells.shape == before
    assert "dropped a scan" in caplog.text
