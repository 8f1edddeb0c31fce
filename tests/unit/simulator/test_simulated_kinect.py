"""The simulated Kinect follows its robot, and repeats itself for the same seed only."""

import numpy as np
import pytest

from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.kinect import KinectModel, kinect_camera
from cliffscan.simulator.world import Pose


def test_a_frame_has_the_contracts_form():
    frame = SimulatedKinect("paper_room").frame()
    assert frame.shape == (480, 640)
    assert frame.dtype == np.uint16


def test_the_same_seed_gives_the_same_frames():
    one, other, third = (SimulatedKinect("paper_room", seed=seed) for seed in (3, 3, 4))
    first = one.frame()
    np.testing.assert_array_equal(first, other.frame())
    np.testing.assert_array_equal(one.frame(), other.frame())
    assert (first != third.frame()).any()


def test_a_frame_at_rest_differs_from_the_last_by_its_noise():
    kinect = SimulatedKinect("paper_room")
    first, second = kinect.frame(), kinect.frame()
    both = (first > 0) & (second > 0)
    assert (first[both] != second[both]).any()
    assert np.median(np.abs(first[both].astype(int) - second[both])) < 40


def test_an_ideal_frame_is_the_depth():
    kinect = SimulatedKinect("stairs_corridor", model=KinectModel.ideal())
    depth = kinect.depth()
    expected = np.where((depth >= 0.5) & (depth <= 4.5), 1000 * depth, 0)
    assert np.abs(kinect.frame() - expected).max() <= 0.501


@pytest.mark.parametrize("pose", [Pose(0.3, -0.2, 0.5), Pose(yaw=np.pi)])
def test_a_robot_that_moved_there_sees_what_one_placed_there_sees(pose):
    moved = SimulatedKinect("paper_room", model=KinectModel.ideal())
    before = moved.frame()
    moved.move(pose)
    placed = SimulatedKinect("paper_room", model=KinectModel.ideal())
    placed.move(pose)
    np.testing.assert_array_equal(moved.frame(), placed.frame())
    assert (moved.frame() != before).any()


def test_the_camera_may_be_tilted():
    kinect = SimulatedKinect("open_floor", model=KinectModel.ideal())
    level = kinect.frame()
    kinect.move(Pose(), kinect_camera(0.30, pitch=0.1))
    tilted = kinect.frame()
    assert np.count_nonzero(tilted) > np.count_nonzero(level)
    assert tilted[-1, 320] < level[-1, 320]


def test_an_impossible_camera_is_refused():
    with pytest.raises(ValueError, match="height"):
        SimulatedKinect("open_floor", kinect_camera(-0.1))
    kinect = SimulatedKinect("open_floor")
    with pytest.raises(ValueError, match="straight down"):
        kinect.move(Pose(), kinect_camera(0.3, pitch=np.pi / 2))


def test_an_unknown_world_is_refused():
    with pytest.raises(ValueError, match="no world"):
        SimulatedKinect("atlantis")
