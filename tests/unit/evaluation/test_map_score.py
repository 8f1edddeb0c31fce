"""Scores of made-up maps of a floor of 2 by 1 m with a wall on its left side and drops round about."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.simulator.kinect import kinect_camera
from cliffscan.simulator.truth import Outline, closed
from cliffscan.simulator.world import Pose, World
from evaluation.map_score import edges_shown, faults, pose_errors, score
from evaluation.truth.world_truth import Ground, drop_points, nearest, seen

CELL = 0.05
ORIGIN = (-0.5, -0.5)
COLUMNS, ROWS = 60, 40
FREE, OCCUPIED, UNKNOWN = 0, 100, -1


def box(left, bottom, right, top):
    return closed(np.array([[left, bottom], [right, bottom], [right, top], [left, top]], float))


@pytest.fixture
def ground():
    floor, wall = box(0, 0, 2, 1), box(-0.1, 0, 0, 1)
    plan = Ground([Outline(floor, "floor"), Outline(wall, "obstacle")], np.empty((0, 2)))
    return plan._replace(edges=drop_points(plan, floor))


@pytest.fixture
def true_map():
    """Free on the floor, occupied where it ends, unknown elsewhere: (rows, columns)."""
    cells = np.full((ROWS, COLUMNS), UNKNOWN, np.int8)
    cells[9:31, 9:51] = OCCUPIED
    cells[10:30, 10:50] = FREE
    return cells


def grid(cells):
    return OccupancyGrid(
        stamp=1, frame="map", resolution=CELL, width=COLUMNS, height=ROWS, origin=(*ORIGIN, 0.0), data=cells.ravel()
    )


def test_the_edges_are_the_sides_without_a_wall(ground):
    assert len(ground.edges) == 100 * (2 + 2 + 1)
    assert ground.edges[:, 0].min() > 0.0
    assert ground.inside("floor", np.array([[1.0, 0.5], [2.1, 0.5]])).tolist() == [True, False]


def test_a_true_map_has_no_fault(ground, true_map):
    told = score(grid(true_map), ground, ground.edges, np.array([0.0, 0.03, 0.04]))
    assert told[:3] == (0.0, 0.0, 1.0)
    assert told.rms == pytest.approx(math.sqrt((0.03**2 + 0.04**2) / 3))
    assert told.final == 0.04


def test_free_cells_beyond_an_edge_are_counted_and_those_on_it_are_not(ground, true_map):
    true_map[12, 50:54] = FREE  # the first one lies at the edge: wholly beyond it, as the others do
    true_map[12, 8] = FREE  # in the wall
    wrong = faults(grid(true_map), ground)
    assert np.argwhere(wrong.free_beyond).tolist() == [[12, 50], [12, 51], [12, 52], [12, 53]]
    assert score(grid(true_map), ground, ground.edges, np.empty(0)).free_beyond == pytest.approx(4 * CELL**2)


def test_occupied_cells_far_from_everything_are_counted_and_those_beyond_the_edge_are_not(ground, true_map):
    true_map[20, 30] = true_map[20, 48] = true_map[20, 55] = true_map[20, 49] = true_map[20, 10] = OCCUPIED
    wrong = faults(grid(true_map), ground)
    assert np.argwhere(wrong.blocked).tolist() == [[20, 30], [20, 48]]


def test_an_edge_that_is_free_on_the_map_is_not_shown(ground, true_map):
    true_map[10:30, 49:52] = FREE  # the right side
    shown = edges_shown(grid(true_map), ground.edges)
    right = ground.edges[:, 0] > 1.99
    assert shown[~right].mean() > 0.98
    assert shown[right].mean() < 0.15  # at its two ends the other sides are near


def test_a_blank_map_shows_nothing(ground):
    blank = grid(np.full((ROWS, COLUMNS), UNKNOWN, np.int8))
    told = score(blank, ground, ground.edges, np.empty(0))
    assert told[:3] == (0.0, 0.0, 0.0)
    assert math.isnan(told.rms)
    assert math.isnan(score(blank, ground, np.empty((0, 2)), np.empty(0)).edges)


def test_poses_are_compared_at_the_same_moment():
    told = {1: (0.0, 0.0, 0.0), 3: (1.0, 1.0, 0.0), 4: (9.0, 9.0, 0.0)}
    true = {3: Pose(1.0, 0.7, 0.0), 2: Pose(5.0, 5.0, 0.0), 1: Pose(0.4, 0.0, 0.0)}
    assert pose_errors(told, true) == pytest.approx([0.4, 0.3])


def test_nearest_of_many_points_and_of_none():
    points = np.random.default_rng(1).uniform(size=(1500, 2))
    assert nearest(points, points + 0.25) == pytest.approx(
        np.array([np.hypot(*(points + 0.25 - point).T).min() for point in points])
    )
    assert np.isinf(nearest(points, np.empty((0, 2)))).all()


def test_the_landings_edges_are_the_stairs_and_the_open_side():
    world = World("landing")
    edges = Ground.of(world).edges
    ahead, right = np.isclose(edges[:, 0], 3.0), np.isclose(edges[:, 1], -2.0)
    assert (ahead | right).all()
    assert ahead.sum() == pytest.approx(320, abs=5)
    assert right.sum() == pytest.approx(450, abs=10)
    view = seen(world, edges, [Pose(0.0, 0.0, 0.0)], kinect_camera(), 4.0)
    assert view[ahead].sum() > 250
    assert not view[right].any()
    assert not seen(world, edges, [Pose(0.0, 0.0, 0.0)], kinect_camera(), 2.9).any()
    assert not seen(world, edges, [Pose(0.0, 0.0, math.pi)], kinect_camera(), 4.0).any()
