"""Maps of a made-up place: walls and edges are where they are, and matching scans beats slipping wheels."""

import math
import sys
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from examples.slam import settings
from examples.slam.odometry_map import OdometryMapper
from examples.slam.pose import Pose
from examples.slam.wire import read_scan
from examples.slam.yag import LoopMatcher, YagMapper
from tests.unit.examples.room import CAMERA, ROOM, START, Room, box, drifting, lap, payload

TOLD = settings.read("test", None, [])
NEAR = 0.72  # [m]
STAIRS = Room(box(-3, -3, 3, 3), edges=[(1.525, -3, 1.525, 3)])


def mapped(mapper, room, poses, odometry):
    """Where the mapper says that the robot was, while it drove along `poses`."""
    for number, (pose, told) in enumerate(zip(poses, odometry, strict=True)):
        scan = read_scan(payload(room.scan(pose, START + number)))
        yield mapper.add(scan, told.then(CAMERA), NEAR).then(CAMERA.step_to(Pose()))


def occupied(grid):
    """x, y [m] of the middle of each occupied cell."""
    rows, columns = np.nonzero(grid.cells >= 65)
    return grid.x + (columns + 0.5) * grid.resolution, grid.y + (rows + 0.5) * grid.resolution


def ends(room, robot):
    """x, y [m] of what a robot's camera sees that is near enough to be drawn."""
    angles, eye = np.linspace(-0.5, 0.5, 100), robot.then(CAMERA)
    ranges, _ = room.look(eye, angles)
    near = ranges < TOLD.reach
    return (
        eye.x + ranges[near] * np.cos(angles + eye.theta)[near],
        eye.y + ranges[near] * np.sin(angles + eye.theta)[near],
    )


def off(poses, truth):
    """Root mean square [m] of how far poses are from the truth."""
    return math.sqrt(np.mean([math.dist(pose[:2], true[:2]) ** 2 for pose, true in zip(poses, truth, strict=True)]))


def test_walls_are_on_the_map_where_they_stand():
    mapper, truth = OdometryMapper(TOLD), list(lap())
    assert list(mapped(mapper, ROOM, truth, truth)) == [pytest.approx(pose) for pose in truth]
    x, y = occupied(mapper.map())
    assert ROOM.distance(x, y).max() < 0.05
    for pose in truth[::10]:
        end_x, end_y = ends(ROOM, pose)
        assert np.hypot(x - end_x[:, None], y - end_y[:, None]).min(axis=1).max() < 0.08  # a cell's diagonal


@pytest.mark.parametrize("make", [OdometryMapper, YagMapper])
def test_stairs_are_an_obstacle_and_nothing_is_known_beyond(make):
    if make is YagMapper:
        pytest.importorskip("yag_slam")
    mapper = make(TOLD)
    poses = [Pose(-1.5 + 0.05 * step, 0.0, 0.0) for step in range(30)]
    list(mapped(mapper, STAIRS, poses, poses))
    grid = mapper.map()
    x, y = occupied(grid)
    assert np.abs(x - 1.525).max() < 0.05
    assert len(np.unique(y)) > 2.0 / grid.resolution
    beyond = round((1.6 - grid.x) / grid.resolution)
    assert (grid.cells[:, beyond:] == -1).all()
    assert (grid.cells[:, :beyond] < 25).sum() > 500


@pytest.mark.parametrize(("stretch", "turn"), [(1.03, 1.04), (1.05, 1.10), (0.97, 0.95)])
def test_matched_scans_are_nearer_to_the_truth_than_wheels_that_slip(stretch, turn):
    pytest.importorskip("yag_slam")
    truth = list(lap())
    odometry = list(drifting(truth, stretch, turn))
    poses = list(mapped(YagMapper(TOLD), ROOM, truth, odometry))
    assert off(poses, truth) < off(odometry, truth) / 2


def test_without_enough_to_match_odometry_leads_on():
    pytest.importorskip("yag_slam")
    mapper, nothing = YagMapper(TOLD), Room(box(-50, -50, 50, 50))
    truth = [Pose(0.1 * step, 0.0, 0.05 * step) for step in range(20)]
    assert list(mapped(mapper, nothing, truth, truth)) == [pytest.approx(pose) for pose in truth]
    assert (mapper.map().cells >= 0).any()


def test_a_missing_package_is_named_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "yag_slam.graph_slam", None)
    with pytest.raises(ImportError, match="pip install yag-slam"):
        YagMapper(TOLD)


class Matching(NamedTuple):
    """What a matcher of yag-slam answers."""

    response: float
    best_pose: object = None


@pytest.mark.parametrize(("coarse", "fine", "response"), [(0.5, 0.7, 0.5), (0.5, 0.5, 0.0), (0.3, 0.9, 0.3)])
def test_a_loop_is_closed_only_where_the_fine_match_agrees(coarse, fine, response):
    matchers = [SimpleNamespace(match_scan=lambda *_, found=found: Matching(found)) for found in (coarse, fine)]
    scan = SimpleNamespace(copy=SimpleNamespace)
    assert LoopMatcher(*matchers).match_scan(scan, [], False, False).response == response
