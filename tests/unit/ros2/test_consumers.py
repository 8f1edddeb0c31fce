"""Ground that nobody saw, mapped as slam_toolbox and Nav2 would: a hole before a wall, and drives past stairs."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.known_ground import known_ground
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.ros2.scans import for_clearing, for_marking, for_slam, range_max
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.world import Pose
from evaluation.truth.world_truth import Ground, nearest
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
    cells = karto(unseen, for_slam(unseen, known_ground(unseen), SLAM_RANGE))
    assert share_free_in_hole(cells) == 0.0
    assert (cells == 0).sum() * CELL**2 > 1.0  # it maps what there is to the left and right


def test_nav2_would_free_the_hole_by_the_fused_ranges_and_does_not_by_marks_and_clear(unseen):
    assert share_free_in_hole(layer(unseen, unseen.ranges, unseen.ranges)) > 0.9
    marks, clears = for_marking(unseen, SLAM_RANGE), for_clearing(unseen, known_ground(unseen), SLAM_RANGE, NEAREST)
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
        clears = for_clearing(seen, known_ground(seen), SLAM_RANGE, NEAREST)
        cells = (
            karto(seen, for_slam(seen, known_ground(seen), SLAM_RANGE))
            if model == "karto"
            else layer(seen, marks, clears)
        )
        row, column = np.divmod(np.flatnonzero(cells == 100), AREA.side)
        points = AREA.low + (np.stack([column, row], axis=1) + 0.5) * CELL
        assert share_free_in_hole(cells) == 0.0
    edge = points[(np.abs(points[:, 1]) < SIDE - CELL) & (points[:, 0] < FAR)]
    assert len(edge) > 10
    np.testing.assert_allclose(edge[:, 0], NEAR, atol=2 * CELL)


def past_the_stairs():
    """Towards the stairs, to the right until the robot looks back, back, and round to the right again."""
    ahead, turn = np.linspace(0.0, 1.5, 11), np.radians(np.arange(0, -180, -12))
    yield from (Pose(x, 0.0, 0.0) for x in ahead)
    yield from (Pose(1.5, 0.0, yaw) for yaw in turn)
    yield from (Pose(x, 0.0, math.pi) for x in ahead[::-1])
    yield from (Pose(0.0, 0.0, math.pi + yaw) for yaw in turn)


class Maps:
    """Maps of a drive: by `/scan`, by `/scan_marks` and `/scan_clear`, and by the ranges of `scan/fused` alone."""

    AREA = Area(-3.0, 8.0)

    def __init__(self, world, floor_lost) -> None:
        self._slam, self._slam_alone = Karto(self.AREA, SLAM_RANGE), Karto(self.AREA, SLAM_RANGE)
        self._layer, self._layer_alone = (ObstacleLayer(self.AREA, SLAM_RANGE, NEAREST) for _ in range(2))
        kinect = SimulatedKinect(world, seed=1)
        settings = Settings(NegativeConfig(floor_lost=floor_lost))
        for number, pose in enumerate(past_the_stairs()):
            kinect.move(pose)
            image = DepthImage.pack(number, number, "eye", kinect.frame(), kinect.camera, "16UC1")
            self._add(perceive(image, settings).fused, pose)
        self._ground = Ground.of(kinect.world)

    def _add(self, scan, pose):
        def seen(ranges):
            return Scan(ranges, scan.grid().angles(), range_max(SLAM_RANGE), pose)

        known = known_ground(scan)
        self._slam.add(seen(for_slam(scan, known, SLAM_RANGE)))
        self._slam_alone.add(seen(scan.ranges))
        self._layer.update(
            seen(for_marking(scan, SLAM_RANGE)), seen(for_clearing(scan, known_ground(scan), SLAM_RANGE, NEAREST))
        )
        self._layer_alone.update(seen(scan.ranges), seen(scan.ranges))

    def free(self):
        """For each map the area [m²] free on the floor, and that of free cells wholly beyond an edge."""
        maps = {
            "slam": self._slam,
            "layer": self._layer,
            "slam alone": self._slam_alone,
            "layer alone": self._layer_alone,
        }
        return {name: self._areas(np.flatnonzero(made.cells() == 0)) for name, made in maps.items()}

    def _areas(self, cells):
        row, column = np.divmod(cells, self.AREA.side)
        centres = self.AREA.low + (np.stack([column, row], axis=1) + 0.5) * CELL
        floor = self._ground.inside("floor", centres)
        off = centres[~floor & ~self._ground.inside("obstacle", centres)]
        beyond = nearest(off, self._ground.edges) >= CELL / 2
        return floor.sum() * CELL**2, beyond.sum() * CELL**2


@pytest.mark.parametrize(
    ("world", "floor_lost", "by_slam_alone", "by_layer_alone", "floor"),
    [("landing", "ignored", 0.15, 1.5, 10.0), ("stairs_corridor", "counts", 0.02, 0.7, 5.0)],
)
def test_no_cell_beyond_the_stairs_is_free_where_ranges_alone_would_free_many(
    world, floor_lost, by_slam_alone, by_layer_alone, floor
):
    free = Maps(world, floor_lost).free()
    for name in ("slam", "layer"):
        assert free[name][1] == 0.0, name
        assert free[name][0] > floor, name
    assert free["slam alone"][1] > by_slam_alone
    assert free["layer alone"][1] > by_layer_alone
