"""Scans that come nearer than the odometry says, and people who walk by."""

import math

import numpy as np
import pytest

from cliffscan.safety.approach_monitor import ApproachMonitor, Glance
from cliffscan.safety.pose2d import Pose2D

ANGLES = np.radians(np.linspace(-29, 29, 640))
PERIOD = 0.1  # [s] between two scans


def wall(x, pose, slope=0.0):
    """Ranges to a wall that crosses the x axis at x [m]."""
    ways = pose.theta + ANGLES
    return (x - pose.x - slope * pose.y) / (np.cos(ways) + slope * np.sin(ways))


def corridor(pose, half=1.0):
    """Ranges to two walls along the x axis."""
    ways = pose.theta + ANGLES
    with np.errstate(divide="ignore"):
        return np.where(np.sin(ways) > 0, (half - pose.y) / np.sin(ways), (half + pose.y) / -np.sin(ways))


def person(ranges, bearing, distance, width=0.5):
    """The same with somebody in the way."""
    half = math.atan2(width / 2, distance)
    return np.where(np.abs(ANGLES - bearing) < half, np.minimum(ranges, distance), ranges)


def drive(scene, share=1.0, turn=0.0, speed=0.4, seconds=4.0, noise=0.0):
    """What is said while a robot drives, whose odometry tells a share of the way."""
    monitor, random = ApproachMonitor(), np.random.default_rng(1)
    true, told = Pose2D(0.0, 0.0, 0.0), Pose2D(0.0, 0.0, 0.0)
    for step in range(round(seconds / PERIOD)):
        ranges = scene(true, step * PERIOD)
        ranges = np.where(ranges < 4.0, ranges + noise * ranges**2 * random.standard_normal(ranges.shape), np.inf)
        if why := monitor.see(Glance(ranges, ANGLES, told, 100.0 + step * PERIOD)):
            return why
        true = true.then(Pose2D(speed * PERIOD, 0.0, turn * PERIOD))
        told = told.then(Pose2D(share * speed * PERIOD, 0.0, turn * PERIOD))
    return ""


SCENES = {
    "a wall ahead": lambda pose, _: wall(3.0, pose),
    "a wall aslant": lambda pose, _: wall(3.0, pose, 0.5),
    "a wall across a corridor": lambda pose, _: np.minimum(corridor(pose), wall(3.0, pose)),
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
@pytest.mark.parametrize("turn", [0.0, 0.1])
def test_an_odometry_that_tells_half_of_the_way_is_found_out(scene, turn):
    assert "times as fast as the odometry says" in drive(scene, share=0.5, turn=turn, noise=0.0015)


@pytest.mark.parametrize("scene", [*SCENES.values(), lambda pose, _: corridor(pose)])
@pytest.mark.parametrize("share", [0.8, 1.0, 1.1])
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_one_that_is_about_right_is_believed(scene, share, turn):
    assert not drive(scene, share=share, turn=turn, noise=0.0015)


@pytest.mark.parametrize("speed", [0.0, 0.3])
def test_people_who_come_nearer_are_people(speed):
    def one(pose, now):
        return person(wall(3.5, pose), 0.2, max(3.0 - 1.2 * now, 0.5))

    def two(pose, now):
        return person(one(pose, now), -0.3, max(2.5 - 0.8 * now, 0.5))

    assert not drive(one, speed=speed)
    assert not drive(two, speed=speed)


def test_one_person_in_an_empty_hall_is_too_narrow_to_tell():
    assert not drive(lambda _, now: person(np.full(640, np.inf), 0.0, max(3.5 - 1.0 * now, 1.6)))


def test_what_moves_along_with_the_robot_does_not_come_nearer():
    assert not drive(lambda *_: np.full(640, 3.0))


def test_where_nothing_is_seen_nothing_is_said():
    assert not drive(lambda *_: np.full(640, np.inf), share=0.5)


def test_a_standing_robot_says_nothing():
    assert not drive(SCENES["a wall ahead"], speed=0.0, noise=0.01)
