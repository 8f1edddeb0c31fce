"""A driver that gets from place to place, whatever the odometry's wrap-around, and gives up what it cannot reach."""

import math
from itertools import pairwise

import pytest

from evaluation.processes.steering import ANGULAR, LINEAR, NEAR, Driver, Look, To, wrapped

TURN = 0.1  # [s]


def driven(steps, pose=(0.0, 0.0, 0.0), blocked=lambda _: False, most=3000):
    """Poses of an ideal robot that obeys a driver, which stands where it is `blocked`; and the driver."""
    driver, poses = Driver(steps), [pose]
    for number in range(most):
        linear, angular = driver.command(poses[-1], round(number * TURN * 1e9))
        assert abs(linear) <= LINEAR
        assert abs(angular) <= ANGULAR
        if driver.finished:
            assert (linear, angular) == (0.0, 0.0)
            return poses, driver
        x, y, heading = poses[-1]
        way = 0.0 if blocked(poses[-1]) else linear * TURN
        poses.append((x + way * math.cos(heading), y + way * math.sin(heading), wrapped(heading + angular * TURN)))
    raise AssertionError("the drive does not end")


@pytest.mark.parametrize("place", [(1, 0), (-1, 0), (0.3, -2), (-0.5, 0.5), (0.0, 0.0)])
def test_every_place_is_reached(place):
    poses, driver = driven([To(*place)])
    assert math.dist(poses[-1][:2], place) < NEAR
    assert not driver.given_up


@pytest.mark.parametrize("degrees", [0, 90, -90, 179, -179, 181])
def test_every_heading_is_reached_on_the_spot_the_shorter_way(degrees):
    poses, _ = driven([Look(degrees)], (1.0, 2.0, 3.0))
    assert {pose[:2] for pose in poses} == {(1.0, 2.0)}
    assert abs(wrapped(poses[-1][2] - math.radians(degrees))) < 0.1
    turned = sum(abs(wrapped(b[2] - a[2])) for a, b in pairwise(poses))
    assert turned < math.pi + 0.1


def test_steps_are_taken_in_order():
    poses, driver = driven([To(1, 0), Look(90), To(1, 1)])
    corner = next(number for number, pose in enumerate(poses) if pose[2] > 1.5)
    assert poses[corner][:2] == pytest.approx((1.0, 0.0), abs=NEAR)
    assert driver.done == 3


def test_a_way_that_is_blocked_is_given_up_and_the_next_step_taken():
    poses, driver = driven([To(2, 0), To(0, 0)], blocked=lambda pose: pose[0] > 1.0 and abs(pose[2]) < 0.1)
    assert driver.given_up == [To(2, 0)]
    assert math.dist(poses[-1][:2], (0, 0)) < NEAR


def test_without_steps_it_is_finished():
    driver = Driver([])
    assert driver.finished
    assert driver.command((0.0, 0.0, 0.0), 1) == (0.0, 0.0)
