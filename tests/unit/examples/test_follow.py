"""Scans find the pose of their moment, whichever comes first."""

import pytest

from examples.slam.follow import WAITING, Follower
from examples.slam.pose import Pose
from examples.slam.wire import UNDESCRIBED, Camera
from tests.unit.examples.room import START, odometry_fields, payload, scan_fields

STEP = 20_000_000  # [ns] between two poses


@pytest.fixture
def follower():
    return Follower()


def receive_odometry(follower, *numbers):
    for number in numbers:
        follower.receive_odometry(
            payload(odometry_fields(Pose(0.1 * number, 0.0, 0.2 * number), START + number * STEP))
        )


def receive_scan(follower, number):
    follower.receive_scan(payload(scan_fields([1.0], [1.0], START + round(number * STEP))))


def test_a_scan_gets_the_pose_between_two(follower):
    receive_odometry(follower, 0, 1, 2)
    receive_scan(follower, 1.25)
    assert follower.next(0).pose == pytest.approx((0.125, 0.0, 0.25))
    assert follower.next(0) is None


def test_a_scan_waits_for_its_pose(follower):
    receive_scan(follower, 0.5)
    receive_odometry(follower, 0)
    assert follower.next(0) is None
    receive_odometry(follower, 1)
    assert follower.next(0).pose == pytest.approx((0.05, 0.0, 0.1))


def test_a_scan_of_the_moment_of_a_pose_gets_that(follower):
    receive_odometry(follower, 3)
    receive_scan(follower, 3)
    assert follower.next(0).pose == pytest.approx((0.3, 0.0, 0.6))


def test_a_scan_from_before_the_first_pose_is_dropped(follower):
    receive_scan(follower, 0.5)
    receive_scan(follower, 1.5)
    receive_odometry(follower, 1, 2)
    assert follower.next(0).scan.stamp == START + round(1.5 * STEP)


def test_a_clock_set_back_begins_anew(follower):
    receive_odometry(follower, 10, 11, 1, 2)
    receive_scan(follower, 1.5)
    assert follower.next(0).pose.x == pytest.approx(0.15)


def test_a_pose_that_was_read_late_while_the_robot_turned_is_not_sure(follower):
    """A reader that stalls for 100 ms finds five poses at once; a regular one is sure however slow it is."""
    late = [number if number < 20 or number > 25 else 25 + 0.01 * (number - 20) for number in range(30)]
    for number, read in enumerate(late):
        told = odometry_fields(Pose(0.0, 0.0, 0.02 * number), START + round(read * STEP))  # 1 rad/s
        follower.receive_odometry(payload(told))
    sure = {}
    for at in (10.5, 18.5, 22.5, 24.5, 25.005, 27.5):
        receive_scan(follower, at)
        sure[at] = follower.next(0).sure
    assert sure == {10.5: True, 18.5: True, 22.5: False, 24.5: False, 25.005: False, 27.5: True}


def test_a_pose_that_was_read_late_while_the_robot_went_straight_is_sure(follower):
    for number, read in enumerate([*range(20), 25, 25.01, 25.02, 25.03, 25.04, 25.05, 26]):
        told = odometry_fields(Pose(0.02 * number, 0.0, 1.0), START + round(read * STEP))
        follower.receive_odometry(payload(told))
    receive_scan(follower, 22.5)
    assert follower.next(0).sure


def test_the_oldest_of_too_many_is_dropped(follower):
    for number in range(WAITING + 1):
        receive_scan(follower, number)
    receive_odometry(follower, 0, WAITING)
    assert follower.next(0).scan.stamp == START + STEP


def test_a_scan_is_of_the_camera_that_was_described_last(follower):
    receive_odometry(follower, 0, 1)
    receive_scan(follower, 0)
    assert follower.next(0).camera == UNDESCRIBED
    camera = {"nearest_floor": 0.4, "x": 0.1, "y": -0.2, "yaw": 0.3}
    follower.receive_description(payload({"stamp": START, "camera": camera}))
    follower.receive_description(payload({"stamp": START, "body": {"radius": 0.18}}))
    receive_scan(follower, 1)
    assert follower.next(0).camera == Camera(Pose(0.1, -0.2, 0.3), 0.4)


def test_bad_samples_are_told_and_dropped(follower, caplog):
    for _ in range(33):
        follower.receive_scan(b"nonsense")
        follower.receive_odometry(b"nonsense")
        follower.receive_description(b"nonsense")
    assert len(caplog.records) == 1
    receive_odometry(follower, 0, 1)
    receive_scan(follower, 1)
    assert follower.next(0)
