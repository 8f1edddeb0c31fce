"""Where the robot was when a scan was taken."""

import math

import pytest

from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.pose_history import AHEAD, ROOM, PoseHistory


def a_history(*poses):
    history = PoseHistory()
    for stamp, pose in poses:
        history.add(stamp, Pose2D(*pose))
    return history


def test_nothing_is_known_at_first():
    assert PoseHistory().at(5) is None


def test_between_two_poses():
    history = a_history((100, (0, 0, 0)), (200, (1, 2, 0.4)))
    assert history.at(150) == pytest.approx((0.5, 1.0, 0.2))
    assert history.at(100) == (0, 0, 0)
    assert history.at(200) == (1, 2, 0.4)


def test_the_short_way_round():
    assert math.cos(a_history((0, (0, 0, 3.1)), (100, (0, 0, -3.1))).at(50).theta) == pytest.approx(-1.0)


def test_before_the_first_and_long_after_the_last_nobody_knows():
    history = a_history((100, (0, 0, 0)), (200, (1, 0, 0)))
    assert history.at(99) is None
    assert history.at(200 + AHEAD) == (1, 0, 0)
    assert history.at(201 + AHEAD) is None


@pytest.mark.parametrize("period", [AHEAD // 50, AHEAD // 5, AHEAD // 2, AHEAD])
def test_after_the_last_the_robot_goes_on_as_before(period):
    stamps = range(0, 4 * AHEAD + 1, period)
    history = a_history(*((stamp, (2.0 * stamp / AHEAD, 0.0, 3.0 + 0.5 * stamp / AHEAD)) for stamp in stamps))
    for late in (0.0, 0.3, 1.0):
        pose = history.at(round((4.0 + late) * AHEAD))
        assert pose.x == pytest.approx(8.0 + 2.0 * late)
        assert math.remainder(pose.theta - 5.0 - 0.5 * late, math.tau) == pytest.approx(0.0, abs=1e-6)


def test_a_pose_that_came_soon_behind_another_throws_nothing_far():
    steady = [(stamp * AHEAD // 5, (0.01 * stamp, 0, 0)) for stamp in range(11)]
    history = a_history(*steady, (2 * AHEAD + 1000, (0.11, 0, 0)))
    assert history.at(3 * AHEAD).x == pytest.approx(0.11 + 0.06, abs=0.001)


def test_the_oldest_are_forgotten():
    history = a_history(*((stamp, (stamp, 0, 0)) for stamp in range(ROOM + 10)))
    assert history.at(9) is None
    assert history.at(10).x == 10
    assert history.full
    assert not a_history(*((stamp, (0, 0, 0)) for stamp in range(ROOM - 1))).full


@pytest.mark.parametrize("stamp", [99, 50])
def test_a_clock_that_goes_back_begins_a_new_history(stamp):
    history = a_history((0, (9, 9, 9)), (100, (9, 9, 9)), (stamp, (1, 1, 1)))
    assert history.at(stamp - 1) is None
    assert history.at(stamp) == (1, 1, 1)


def test_packets_that_are_read_together_do_not_forget_where_the_robot_was():
    history = PoseHistory()
    for stamp, x in [(100, 0.0), (200, 1.0), (200, 2.0), (300, 3.0)]:
        history.add(stamp, Pose2D(x, 0.0, 0.0))
    assert [history.at(stamp).x for stamp in (100, 150, 200, 250)] == [0.0, 1.0, 2.0, 2.5]
