"""The sensor's border is learnt from views that differ, and a hole right before the robot never passes for one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.services.capture.region import RegionLearner, differ, grid
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.kinect import KinectModel, kinect_camera, measure
from cliffscan.simulator.world import Pose
from tests import scenes

BORDER = Region(9, 11, 627, 463)
WHOLE = Region.whole(640, 480)
MOUNT = FloorPlane.from_mount(0.30)
CAMERA = scenes.camera(320, 240, MOUNT, (0.5, 4.5))
RNG = np.random.default_rng(5)
PLACES = [Pose(0.1 * n, 0.05 * n, 0.5 * n) for n in range(8)]
TRENCH = (0.5, -9.0, -0.5, 0.92, 9.0, 0.0)  # begins nearer than the camera sees, and hides the image's last 25 rows


def cut(depth, region):
    """The same image with nothing outside a region."""
    left, top, right, bottom = region
    inside = np.zeros_like(depth)
    inside[top : bottom + 1, left : right + 1] = depth[top : bottom + 1, left : right + 1]
    return inside


def views(poses=PLACES):
    """What a robot in a furnished room sees on its way."""
    kinect = SimulatedKinect("office", kinect_camera())
    for pose in poses:
        kinect.move(pose)
        yield kinect.frame()


def learnt(pictures):
    """The region after each picture."""
    learner = RegionLearner()
    return [learner.update(picture) for picture in pictures]


def noisy(camera, holes=(), seed=None, **scene):
    """A made-up place as a Kinect sees it; what a hole's walls and bottom return is lost."""
    exact, flat = scenes.depth(camera, holes=list(holes), **scene), scenes.depth(camera, **scene)
    seen = np.where((exact == flat) & (exact > 0), exact, 0)
    inverse = np.divide(1000.0, seen, out=np.zeros(seen.shape), where=seen > 0).astype(np.float32)
    return measure(inverse, camera, KinectModel(), RNG if seed is None else np.random.default_rng(seed))


def at(depth, x=0.0):
    """A trench of the scene's after the robot drove on by x [m]."""
    near, right, low, far, left, high = depth
    return near - x, right, low, far - x, left, high


def test_a_border_is_learnt_from_views_that_differ_and_no_sooner():
    found = learnt(cut(view, BORDER) for view in views())
    assert found[:2] == [None, None]
    assert found[-1] == BORDER


def test_each_side_is_learnt_by_itself():
    rows = np.linspace(1500, 800, 480)[:, None]
    pictures = [np.repeat(factor * rows, 640, axis=1).astype(np.uint16) for factor in (1.0, 1.2, 1.5)]
    assert learnt(cut(each, BORDER) for each in pictures)[-1] == BORDER
    upper = Region(0, 20, 639, 479)
    assert learnt(cut(each, upper) for each in pictures)[-1] == upper


def test_where_somebody_knows_that_there_is_no_hole_one_view_is_enough():
    learner = RegionLearner(views=1)
    picture = cut(np.full((480, 640), 1000, np.uint16), BORDER)
    assert learner.update(picture) == BORDER
    assert learner.update(np.full_like(picture, 1000)) is None


def test_a_sensor_without_a_border_has_none():
    assert not any(learnt(views()))


def test_a_return_beyond_takes_the_border_back_at_once():
    learner = RegionLearner()
    pictures = [cut(view, BORDER) for view in views()]
    for picture in pictures:
        region = learner.update(picture)
    assert region == BORDER
    once = pictures[0].copy()
    once[478, 300] = 700
    assert learner.update(once) == BORDER._replace(last_row=479)
    for picture in pictures:  # for good: what returned once can return
        assert learner.update(picture) == BORDER._replace(last_row=479)


def test_more_than_an_eighth_of_the_image_is_no_border():
    assert not any((each or WHOLE).last_row < 479 for each in learnt(cut(v, Region(0, 0, 639, 418)) for v in views()))


@pytest.mark.parametrize("still", ["noise", "nod", "sway"])
def test_a_robot_that_stands_before_a_hole_takes_it_for_no_border(still):
    learner = RegionLearner()
    for number in range(40):
        swing = math.radians(2.0 * math.sin(2 * math.pi * number / 20))
        pitch, roll = {"noise": (0.0, 0.0), "nod": (swing, 0.0), "sway": (0.0, swing)}[still]
        camera = replace(CAMERA, floor=FloorPlane.from_mount(0.30, pitch, roll))
        depth = noisy(camera, [TRENCH], wall=3.0)
        assert still != "noise" or not depth[220:].any()  # the hole is as wide as the view
        assert learner.update(depth) is None


@pytest.mark.parametrize("step", [0.02, -0.02])
def test_a_robot_that_drives_toward_a_hole_or_away_takes_it_for_no_border(step):
    for start in (0.0, -0.25):
        pictures = (noisy(CAMERA, [at(TRENCH, start + step * n)], wall=3.0 - step * n) for n in range(15))
        assert not any(learnt(pictures))


def test_a_robot_that_turns_before_a_hole_takes_it_for_no_border():
    learner = RegionLearner()
    others = []
    for yaw in np.radians(20.0 * np.sin(np.linspace(0.0, 6.0, 33))):
        depth = turned_away(noisy(CAMERA, wall=1.7 + 0.7 * math.sin(9 * yaw)), yaw)
        if all(differ(grid(depth), each) for each in others):
            others.append(grid(depth))
        assert learner.update(depth) is None
    assert len(others) >= 3  # it sees other places meanwhile


def turned_away(depth, yaw):
    """The floor and walls in an image of CAMERA, less a trench as wide as the view, square to the robot at yaw 0."""
    v, u = np.mgrid[0:240, 0:320]
    fx, fy, cx, cy = CAMERA.intrinsics
    z = depth / 1000.0
    ahead = z * math.cos(yaw) + z * (u - cx) / fx * math.sin(yaw)
    on_floor = 0.30 - z * (v - cy) / fy < 0.02
    return np.where(on_floor & (ahead < 0.92), 0, depth).astype(np.uint16)


@pytest.mark.parametrize("depth", [0, 700])
def test_a_picture_that_stays_teaches_nothing(depth):
    picture = cut(np.full((480, 640), depth, np.uint16), BORDER)
    assert not any(learnt([picture] * 20))


def test_noise_makes_no_other_view():
    kinect = SimulatedKinect("office")
    one, other = kinect.frame(), kinect.frame()
    assert (one != other).any()
    assert not differ(grid(one), grid(other))


def test_the_grid_has_the_median_of_what_returned():
    depth = np.repeat(np.repeat(np.arange(1, 49).reshape(6, 8) * 100, 80, axis=0), 80, axis=1).astype(np.uint16)
    np.testing.assert_array_equal(grid(depth), np.arange(1, 49).reshape(6, 8) * 100)
    lost = depth.copy()
    lost[RNG.random(depth.shape) < 0.2] = 0
    np.testing.assert_array_equal(grid(lost), grid(depth))
    assert not grid(np.zeros_like(depth)).any()


def test_another_sensor_begins_anew():
    learner = RegionLearner()
    for view in views():
        learner.update(cut(view, BORDER))
    assert learner.update(np.full((240, 320), 900, np.uint16)) is None


@pytest.mark.parametrize("shape", [(2, 2), (2, 640), (7, 9)])
def test_any_size_of_image_will_do(shape):
    for value in (0, 1000, 2000, 3000):
        picture = np.full(shape, value, np.uint16)
        picture[-1] = 0
        RegionLearner().update(picture)
