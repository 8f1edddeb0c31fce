"""What is remembered of the floor, and what makes it forget."""

import copy
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.safety.hull import Disc
from cliffscan.safety.local_grid import CELL, FREE, HALF_CELL, LOOK, MEMORY, RollingGrid
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.visible_floor import EVERYWHERE, VisibleFloor
from tests.gate_drive import taken_at_its_word

HERE = Pose2D(0.0, 0.0, 0.0)
ANGLES = np.radians(np.linspace(-29, 29, 640))
BLIND = 0.75
FLOOR = VisibleFloor(BLIND, EVERYWHERE)
RADIUS = 0.18

poses = st.builds(Pose2D, st.floats(-50, 50), st.floats(-50, 50), st.floats(-10, 10))


def see(grid, ranges, pose=HERE, angles=ANGLES, range_max=4.0, free=None, edges=False):
    ranges = np.broadcast_to(np.asarray(ranges, float), angles.shape).copy()
    free = taken_at_its_word(ranges, range_max) if free is None else np.full(angles.shape, free)
    grid.see(ranges, np.full(angles.shape, edges), free, angles, pose, FLOOR)


def occupied(grid, pose=HERE, reach=LOOK):
    """Distances [m] from `pose` of the cells that are not free although known, the nearest first."""
    return np.sort(np.hypot(*grid.not_free(pose, reach, unknown_too=False)))


def unknown_ahead(grid, pose=HERE, half_width=0.1):
    """Distance [m] of the first cell straight ahead that is not free."""
    x, y = grid.not_free(pose, LOOK, unknown_too=True)
    return x[(x > 0) & (np.abs(y) < half_width)].min(initial=math.inf)


@pytest.mark.parametrize("start", [HERE, Pose2D(-7.3, 12.1, 2.0)])
def test_where_it_begins_is_free_and_nothing_else(start):
    grid = RollingGrid(start, 0.5)
    x, y = grid.not_free(start, LOOK, unknown_too=True)
    assert 0.5 <= np.hypot(x, y).min() < 0.5 + 3 * CELL
    assert not occupied(grid, start).size


def test_a_clear_view_frees_what_it_crosses_also_in_the_blind_zone():
    grid = RollingGrid(HERE, 0.2)
    see(grid, np.inf)
    assert unknown_ahead(grid, half_width=0.05) >= LOOK - 3 * CELL
    see(grid, 2.0)
    assert unknown_ahead(grid, half_width=0.05) >= LOOK - 3 * CELL


def test_beams_not_seen_free_nothing():
    grid = RollingGrid(HERE, 0.5)
    see(grid, np.nan)
    assert unknown_ahead(grid) < 0.5 + 3 * CELL
    assert not occupied(grid).size
    see(grid, np.where(np.arange(640) % 2, np.nan, np.inf))  # a cell is wider than a beam
    assert unknown_ahead(grid) < 0.5 + 3 * CELL


def test_beams_free_nothing_beyond_the_floor_that_was_seen():
    grid = RollingGrid(HERE, 0.3)
    see(grid, 2.0, free=1.0)
    assert 1.0 - 2 * CELL <= unknown_ahead(grid) <= 1.0 + CELL
    see(grid, math.nan, free=1.2)
    assert 1.2 - 2 * CELL <= unknown_ahead(grid) <= 1.2 + CELL


def test_beams_not_seen_undo_nothing():
    grid = RollingGrid(HERE, 0.5)
    see(grid, 1.0)
    before = occupied(grid)
    see(grid, np.nan)
    assert (occupied(grid) == before).all()


def test_a_hole_that_begins_in_the_blind_zone_leaves_the_zone_unknown():
    """The first the camera sees is at BLIND that there is no floor: where it begins, nobody knows."""
    grid = RollingGrid(HERE, 0.4)
    see(grid, BLIND)
    assert unknown_ahead(grid) < 0.4 + 3 * CELL


@pytest.mark.parametrize("guessed", [False, True])
@pytest.mark.parametrize("edges", [False, True])
def test_an_edge_may_go_on_beside_where_it_was_seen(edges, guessed):
    """Nearer than floor is seen at all a hole's corner may reach into view; beside a post there is floor."""
    grid = RollingGrid(HERE, 0.3)
    if guessed:
        see(grid, math.inf)
    see(grid, np.where(ANGLES > 0.1, 0.85, math.inf), edges=edges)
    x, y = grid.not_free(HERE, 1.2, unknown_too=True)
    before = (x > 0.6) & (x < 0.68)
    assert (before & (np.abs(y) < 0.05)).any() == edges
    assert not (before & (np.abs(y + 0.25) < 0.05)).any()


def test_the_first_of_a_scan_is_marked_up_to_where_memory_ends():
    for far in (0.6, 1.2, 2.0, MEMORY - 0.1):
        grid = RollingGrid(HERE, 0.5)
        see(grid, np.where(np.arange(640) == 320, far, np.inf))
        grid.follow(Pose2D(far - 1.0, 0.0, 0.0), Disc(RADIUS))
        assert occupied(grid, Pose2D(far - 1.0, 0.0, 0.0))[0] == pytest.approx(1.0, abs=HALF_CELL + CELL)


@pytest.mark.parametrize("ranges", [np.inf, np.nan, 3.0])
def test_an_edge_that_leaves_the_view_stays(ranges):
    grid = RollingGrid(HERE, 0.5)
    see(grid, 1.0)
    for millimetres in range(0, 1000, 10):
        pose = Pose2D(millimetres / 1000, 0.0, 0.0)
        grid.follow(pose, Disc(RADIUS))
        distance = 1.0 - pose.x
        see(grid, distance if distance >= BLIND else ranges, pose)
        assert occupied(grid, pose)[0] <= abs(distance) + CELL


def test_a_cell_is_seen_to_be_free_only_if_all_of_it_is_out_of_the_blind_zone():
    for far in np.arange(0.60, 1.0, 0.005):
        grid = RollingGrid(HERE, 0.5)
        see(grid, np.where(np.abs(ANGLES) < 0.01, far, np.inf))
        assert occupied(grid).size
        see(grid, np.inf)
        assert occupied(grid).size or far >= BLIND
        assert not occupied(grid).size or far < BLIND + 3 * HALF_CELL


def test_what_went_away_is_forgotten_when_its_place_is_seen_to_be_free():
    grid = RollingGrid(HERE, 0.5)
    see(grid, 1.2)
    assert occupied(grid).size
    see(grid, np.inf)
    assert len(occupied(grid)) < 5  # a cell at the scan's very side is never seen whole


def test_it_is_forgotten_3_m_away_and_not_before():
    for way in (Pose2D(-1, 0, 0), Pose2D(0, -1, 0), Pose2D(0, 1, 0)):
        for far, stays in ((1.5, True), (1.8, True), (3.2, False)):
            grid = RollingGrid(HERE, 0.5)
            see(grid, np.where(np.arange(640) == 320, 1.0, np.inf))
            out = Pose2D(1.0 + way.x * far if way.x else 1.0, way.y * far, 0.0)
            for share in np.linspace(0, 1, 400):
                grid.follow(Pose2D(share * out.x, share * out.y, 0.0), Disc(RADIUS))
            grid.follow(HERE, Disc(RADIUS))
            assert bool(occupied(grid).size) == stays


@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(-1, 1)), min_size=1, max_size=4), st.floats(5, 40))
def test_wandering_far_in_any_direction_it_is_the_same_as_a_dictionary(legs, length):
    grid, known = RollingGrid(HERE, 0.0), {}
    x = y = 0.0
    for dx, dy in legs:
        for _ in range(15):
            x, y = x + dx * length / 15, y + dy * length / 15
            grid.follow(Pose2D(x, y, 0.0), Disc(0.0))
            centre = (math.floor(x / CELL), math.floor(y / CELL))
            half = round(MEMORY / CELL)
            known = {k: v for k, v in known.items() if all(-half <= k[i] - centre[i] < half for i in (0, 1))}
            spot = (x + 0.7, y - 0.3)
            grid.occupy(np.array([[spot[0]], [spot[1]]]))
            known[math.floor(spot[0] / CELL), math.floor(spot[1] / CELL)] = True
    found = Pose2D(x, y, 0.0).to_world(grid.not_free(Pose2D(x, y, 0.0), 1.4, unknown_too=False))
    cells = {(math.floor(a / CELL), math.floor(b / CELL)) for a, b in found.T}
    assert cells <= known.keys()
    assert {k for k in known if math.dist(((k[0] + 0.5) * CELL, (k[1] + 0.5) * CELL), (x, y)) < 1.4} <= cells


def test_only_the_disc_itself_is_taken_for_floor():
    """Else the robot would free the cells in front of it by coming near, and creep on and on."""
    grid = RollingGrid(HERE, 0.0)
    for dx in np.linspace(0, CELL, 9):
        grid.follow(Pose2D(dx, dx / 2, 0.0), Disc(RADIUS))
    x, y = grid.not_free(Pose2D(CELL, CELL / 2, 0.0), 0.5, unknown_too=True)
    swept = np.min([np.hypot(x + CELL * (1 - s), y + CELL / 2 * (1 - s)) for s in np.linspace(0, 1, 9)], axis=0)
    assert swept.min() >= RADIUS - 1e-9
    assert swept.min() <= RADIUS + CELL


def test_a_touch_is_undone_by_no_scan_but_forgiven():
    grid = RollingGrid(HERE, 0.5)
    see(grid, np.inf)
    grid.touch(np.array([[1.0], [0.0]]))
    see(grid, np.inf)
    grid.follow(Pose2D(0.9, 0.0, 0.0), Disc(RADIUS))
    assert occupied(grid).size == 1
    grid.forgive()
    assert not occupied(grid).size


def test_to_forgive_a_touch_is_not_to_forget_what_was_seen_there():
    grid = RollingGrid(HERE, 0.5)
    touched_first, seen_first = np.array([[1.2], [0.0]]), np.array([[1.0], [0.0]])
    grid.touch(touched_first)
    for point in (touched_first, seen_first):
        grid.occupy(point)
        grid.touch(point)
    grid.forgive()
    assert occupied(grid).size == 2


def test_a_touch_is_left_behind():
    grid = RollingGrid(HERE, 0.5)
    grid.touch(np.array([[0.2], [0.0]]))
    grid.follow(Pose2D(3.3, 0.0, 0.0), Disc(RADIUS))
    grid.follow(HERE, Disc(RADIUS))
    assert not occupied(grid).size


def test_to_begin_again_keeps_what_is_in_the_way():
    grid = RollingGrid(HERE, 0.5)
    see(grid, np.where(np.abs(ANGLES) < 0.1, 1.0, np.inf))
    grid.doubt()
    grid.follow(HERE, Disc(0.3))
    assert occupied(grid)[0] == pytest.approx(1.0, abs=CELL)
    x, y = grid.not_free(HERE, LOOK, unknown_too=True)
    assert 0.3 <= np.hypot(x, y).min() < 0.3 + 3 * CELL


@pytest.mark.parametrize(("heading", "way"), [(0.0, 0.3), (0.0, -0.3), (0.5, 0.3), (math.pi / 2, 0.3)])
def test_what_may_be_somewhere_along_the_way_is_there(heading, way):
    """As if each cell of the grid were looked at from all places where the robot may be."""
    grid = RollingGrid(HERE, 0.5)
    see(grid, np.where(np.abs(ANGLES) < 0.1, 1.0, np.inf))
    grid.touch(np.array([[-0.4], [0.2]]))
    kept = copy.deepcopy(grid)
    grid.smear(heading, way)
    middles = CELL * (np.arange(-40, 40) + 0.5)
    points = np.stack(np.meshgrid(middles, middles)).reshape(2, -1)
    along = np.array([math.cos(heading), math.sin(heading)])[:, None]
    shown = np.array([kind(grid, point) for point in points.T])
    for share in (0.0, 0.3, 0.7, 1.0):
        true = np.array([kind(kept, point) for point in (points + share * way * along).T])
        assert (shown >= true).all()
    assert (shown == FREE).sum() > 100


def test_a_robot_that_may_be_anywhere_knows_nothing_to_be_free():
    grid = RollingGrid(HERE, 0.5)
    see(grid, np.full(len(ANGLES), np.inf))
    grid.smear(0.0, 1e9)
    assert np.hypot(*grid.not_free(HERE, LOOK, unknown_too=True)).min() < CELL


def kind(grid, point):
    """FREE to TOUCHED of the cell at a point (2,) [m]."""
    window = grid.around(Pose2D(*point, 0.0), 0.0)
    return window.cells[0, 0]


def test_a_robot_that_was_carried_knows_nothing():
    grid = RollingGrid(HERE, 0.5)
    see(grid, np.where(np.abs(ANGLES) < 0.1, 1.0, np.inf))
    grid.touch(np.array([[0.2], [0.0]]))
    grid.forget()
    assert not occupied(grid).size
    assert np.hypot(*grid.not_free(HERE, LOOK, unknown_too=True)).min() < CELL


@pytest.mark.parametrize("angles", [[0.0], [0.0, 0.1], [1.5, 2.5], np.linspace(-math.pi, math.pi, 720)])
def test_scans_of_any_shape_are_taken(angles):
    grid = RollingGrid(HERE, 0.5)
    angles = np.array(angles)
    see(grid, 1.0, angles=angles)
    assert occupied(grid).size
    see(grid, np.inf, angles=angles)


@given(poses, st.floats(0.8, 1.4), st.floats(-0.4, 0.4))
def test_a_scan_is_put_where_the_robot_was(pose, far, azimuth):
    grid = RollingGrid(pose, 0.5)
    see(grid, np.where(np.arange(640) == np.argmin(np.abs(ANGLES - azimuth)), far, np.inf), pose)
    where = grid.not_free(pose, LOOK, unknown_too=False)
    assert where.shape[1] == 1
    assert np.hypot(where[0] - far * math.cos(azimuth), where[1] - far * math.sin(azimuth)) < HALF_CELL + 0.01
