"""A hole that nobody could look into, with a wall behind it, mapped as slam_toolbox and Nav2 would."""

import numpy as np
import pytest

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.ros2.scans import for_clearing, for_marking, for_slam, range_max
from tests.ros2_consumers import CELL, Area, Karto, ObstacleLayer, Scan, collision_monitor_points
from tests.scenes import depth

SLAM_RANGE, NEAREST = 4.0, 0.72
NEAR, FAR, SIDE, WALL = 1.2, 2.2, 0.5, 3.0  # [m] the hole's sides ahead and to left and right, and the wall
HOLE = (NEAR, -SIDE, -1.0, FAR, SIDE, 0.0)
AREA = Area(-4.0, 5.0)
CAMERA = Camera(640, 480, Intrinsics(575.8, 575.8, 319.5, 239.5), (0.5, 4.5), FloorPlane.from_mount(0.3))


def fused(image, floor_lost="counts"):
    settings = Settings(NegativeConfig(floor_lost=floor_lost))
    return perceive(DepthImage.pack(1, 1, "eye", image, CAMERA, "16UC1"), settings).fused


@pytest.fixture(scope="module")
def unseen():
    """No pixel of the hole returns anything, and the user has said that lost floor is no edge: there is a wall only."""
    image = depth(CAMERA, [HOLE], wall=WALL)
    image[image != depth(CAMERA, wall=WALL)] = 0
    return fused(image, "ignored")


@pytest.fixture(scope="module")
def seen():
    return fused(depth(CAMERA, [HOLE], wall=WALL))


def as_ros(scan, ranges):
    return Scan(ranges, scan.grid().angles(), range_max(SLAM_RANGE), (0.0, 0.0, 0.0))


def share_free_in_hole(cells):
    """The share of the hole's cells, but for those at its rim, that are free."""
    row, column = np.divmod(np.arange(len(cells)), AREA.side)
    ahead, left = AREA.low + (column + 0.5) * CELL, AREA.low + (row + 0.5) * CELL
    inside = (ahead > NEAR + 2 * CELL) & (ahead < FAR) & (np.abs(left) < SIDE - 2 * CELL)
    return (cells[inside] == 0).mean()


def karto(scan, ranges):
    made = Karto(AREA, SLAM_RANGE)
    for _ in range(Karto.LEAST_PASSES):
        made.add(as_ros(scan, ranges))
    return made.cells()


def layer(scan, marks, clears):
    made = ObstacleLayer(AREA, SLAM_RANGE, NEAREST)
    made.update(as_ros(scan, marks), as_ros(scan, clears))
    return made.cells()


def test_slam_toolbox_would_free_the_hole_by_the_fused_ranges_and_does_not_by_scan(unseen):
    assert share_free_in_hole(karto(unseen, unseen.ranges)) > 0.9
    cells = karto(unseen, for_slam(unseen, SLAM_RANGE))
    assert share_free_in_hole(cells) == 0.0
    assert (cells == 0).sum() * CELL**2 > 1.0  # it maps what there is to the left and right


def test_nav2_would_free_the_hole_by_the_fused_ranges_and_does_not_by_marks_and_clear(unseen):
    assert share_free_in_hole(layer(unseen, unseen.ranges, unseen.ranges)) > 0.9
    marks, clears = for_marking(unseen, SLAM_RANGE), for_clearing(unseen, SLAM_RANGE, NEAREST)
    cells = layer(unseen, marks, clears)
    assert share_free_in_hole(cells) == 0.0
    assert (cells == 0).sum() * CELL**2 > 1.0
    assert (cells == 100).sum() > 20  # the wall


@pytest.mark.parametrize("model", ["karto", "nav2", "collision monitor"])
def test_a_hole_that_is_seen_is_marked_at_its_edge(seen, model):
    marks = for_marking(seen, SLAM_RANGE)
    if model == "collision monitor":
        points = collision_monitor_points(as_ros(seen, marks))
    else:
        clears = for_clearing(seen, SLAM_RANGE, NEAREST)
        cells = karto(seen, for_slam(seen, SLAM_RANGE)) if model == "karto" else layer(seen, marks, clears)
        row, column = np.divmod(np.flatnonzero(cells == 100), AREA.side)
        points = AREA.low + (np.stack([column, row], axis=1) + 0.5) * CELL
        assert share_free_in_hole(cells) == 0.0
    edge = points[(np.abs(points[:, 1]) < SIDE - CELL) & (points[:, 0] < FAR)]
    assert len(edge) > 10
    np.testing.assert_allclose(edge[:, 0], NEAR, atol=2 * CELL)
