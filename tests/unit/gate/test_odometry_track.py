"""Odometry of any base becomes one that never jumps, and what cannot be is noticed."""

import math

import pytest

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.services.gate.config import GateConfig
from cliffscan.services.gate.odometry_track import WHEEL_SEPARATION, OdometryTrack

PERIOD = 0.02


def message(seconds, x=0.0, y=0.0, theta=0.0):
    return Odometry(
        stamp=10**18 + round(seconds * 1e9), frame="odom", child_frame="base_link", pose=(x, y, theta),
        twist=(0.0, 0.0), pose_covariance=[0.0] * 9, twist_covariance=[0.0] * 9,
    )  # fmt: skip


@pytest.fixture
def track():
    made = OdometryTrack(GateConfig().limits())
    assert made.update(message(0.0, 5.0, 3.0, 1.0), 100.0).new_baseline == "first odometry"
    return made


def drive(track, ticks, begin=0, now=100.0, speed=0.4, turn=0.5):
    """Along an arc from where the base says that it is; the last step."""
    for tick in range(begin + 1, begin + ticks + 1):
        at = tick * PERIOD
        theta = 1.0 + turn * at
        x = 5.0 + speed / turn * (math.sin(theta) - math.sin(1.0))
        y = 3.0 - speed / turn * (math.cos(theta) - math.cos(1.0))
        step = track.update(message(at, x, y, math.remainder(theta, math.tau)), now + at)
    return step


def test_an_arc_is_followed_from_the_origin_with_the_ways_of_both_wheels(track):
    step = drive(track, 400)
    assert step.motion.clock == pytest.approx(8.0)
    assert (step.motion.left + step.motion.right) / 2 == pytest.approx(3.2, abs=1e-3)
    assert (step.motion.right - step.motion.left) / WHEEL_SEPARATION == pytest.approx(4.0, abs=1e-6)
    assert (step.pose.x, step.pose.y) == pytest.approx((0.8 * math.sin(4.0), 0.8 * (1 - math.cos(4.0))), abs=1e-6)


def test_a_base_that_starts_anew_leaves_the_robot_where_it_was(track):
    before = drive(track, 50)
    anew = track.update(message(9.0), 109.0)
    assert anew.motion is None
    assert (anew.pose.x, anew.pose.y) == pytest.approx((before.pose.x, before.pose.y))
    after = track.update(message(9.02, 0.008), 109.02)
    heading = before.pose.theta
    assert after.pose.x - anew.pose.x == pytest.approx(0.008 * math.cos(heading), abs=1e-9)


def test_what_is_repeated_is_nothing_new(track):
    drive(track, 3)
    assert drive(track, 1, begin=2, now=100.5) is None


@pytest.mark.parametrize(
    ("stamps", "ours", "way", "why"),
    [
        (-1.0, 0.02, 0.0, "went back"),
        (0.02, 0.02, 0.5, "leapt"),
        (0.40, 0.02, 0.0, "clock went on"),
    ],
)
def test_what_no_base_can_report_is_a_contradiction(track, stamps, ours, way, why):
    for tick in range(1, 301):
        track.update(message(tick * PERIOD, 5.0, 3.0, 1.0), 100.0 + tick * PERIOD)
    step = track.update(message(6.0 + stamps, 5.0 + way, 3.0, 1.0), 106.0 + ours)
    assert step.contradiction
    assert why in step.new_baseline


def test_a_message_that_was_overtaken_moves_nothing(track):
    drive(track, 50)
    late = track.update(message(0.9, 5.4, 3.2, 1.0), 101.01)
    assert late.contradiction
    other = OdometryTrack(GateConfig().limits())
    other.update(message(0.0, 5.0, 3.0, 1.0), 100.0)
    drive(other, 50)
    assert drive(track, 1, begin=50).pose == drive(other, 1, begin=50).pose


def test_a_clock_that_was_set_back_for_good_begins_anew(track):
    drive(track, 50)
    steps = [track.update(message(tick * PERIOD - 3600.0, 5.0, 3.0, 1.0), 101.0 + tick * PERIOD) for tick in range(60)]
    assert steps[0].contradiction
    assert steps[-1].motion


def test_a_gap_is_a_new_baseline_and_no_contradiction(track):
    drive(track, 3)
    step = track.update(message(2.0, 5.1, 3.1, 1.0), 102.0)
    assert step.new_baseline == "1.94 s between two messages of odometry"
    assert not step.contradiction
