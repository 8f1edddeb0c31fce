"""What happened between two packets, and when that cannot be told."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from cliffscan.safety.base_clock import Discontinuity
from cliffscan.services.kobuki.kinematics import METRES_PER_TICK
from cliffscan.services.kobuki.odometry_increment import Reading, increment_between
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import core, inertia

TICKS_PER_METRE = 11724.41658
START = Reading(1000, 100, 100, 0.5, 7.0)


def after(ms=20, left=0, right=0, angle=0.0, now=0.02, start=START):
    """A reading so many ms, ticks, radians and seconds after another."""
    turned = None if start.angle is None or angle is None else math.remainder(start.angle + angle, math.tau)
    return Reading(
        (start.timestamp + ms) & 0xFFFF,
        (start.left + left) & 0xFFFF,
        (start.right + right) & 0xFFFF,
        turned,
        start.now + now,
    )


def test_a_reading_is_taken_from_a_packet():
    with_gyro = decode(core(40, 5, 6) + inertia(9000))
    assert Reading.of(with_gyro.core, with_gyro.inertia, 3.0) == (40, 5, 6, pytest.approx(math.pi / 2), 3.0)
    assert Reading.of(with_gyro.core, None, 3.0).angle is None


def test_the_wheels_tell_the_distance_and_the_gyro_the_turn():
    step = increment_between(START, after(20, 100, 140, 0.01))
    assert step == (pytest.approx(120 / TICKS_PER_METRE), pytest.approx(0.01), 0.02, True)


@pytest.mark.parametrize("blind", [START._replace(angle=None), START])
def test_without_a_gyro_the_wheels_tell_the_turn(blind):
    step = increment_between(blind, after(20, 100, 140)._replace(angle=None))
    assert step == (pytest.approx(120 / TICKS_PER_METRE), pytest.approx(40 / TICKS_PER_METRE / 0.23), 0.02, False)


@given(
    st.integers(0, 0xFFFF), st.integers(0, 0xFFFF), st.integers(-300, 300), st.integers(-300, 300), st.integers(1, 500)
)
def test_counters_may_wrap(timestamp, encoder, left, right, ms):
    start = Reading(timestamp, encoder, encoder ^ 0x8000, 3.1, 0.0)
    step = increment_between(start, after(ms, left, right, 0.09, start=start))
    assert step.distance == pytest.approx((left + right) / 2 * METRES_PER_TICK)
    assert step.seconds == pytest.approx(ms / 1000)
    assert step.turn == pytest.approx(0.09)


@pytest.mark.parametrize("angle", [0.15, -0.15])
@pytest.mark.parametrize("start", [math.pi - 0.1, 0.1 - math.pi])
def test_the_gyros_angle_may_wrap(start, angle):
    start = START._replace(angle=start)
    assert increment_between(start, after(angle=angle, start=start)).turn == pytest.approx(angle)


def test_a_clock_that_stands_still_brings_nothing_new():
    assert increment_between(START, after(0, 10, 10)) is None


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"ms": 501}, "clock went from 1000 to 1501 ms"),
        ({"ms": 32768}, "clock went from 1000 to 33768 ms"),
        ({"ms": -20}, "clock went from 1000 to 980 ms"),
        ({"ms": -1000}, "clock went from 1000 to 0 ms"),
        ({"now": 1.01}, "1.01 s between two packets"),
        ({"now": 65.556}, "65.56 s between two packets"),
        ({"now": -0.01}, "-0.01 s between two packets"),
        ({"ms": 0, "now": 2.0}, "2.00 s between two packets"),
        ({"left": 704}, "wheels leapt by 0.06 and 0.00 m in 0.020 s"),
        ({"right": -704}, "wheels leapt by 0.00 and -0.06 m"),
        ({"ms": 250, "left": -5041, "right": -5041}, "wheels leapt by -0.43 and -0.43 m"),
        ({"angle": 0.21}, "gyro leapt by 12 degrees in 0.020 s"),
        ({"angle": -3.0}, "gyro leapt by -172 degrees"),
    ],
)
def test_a_leap_is_no_step(change, why):
    with pytest.raises(Discontinuity) as error:
        increment_between(START, after(**change))
    assert why in str(error.value)


@pytest.mark.parametrize(
    "change", [{"ms": 500}, {"now": 1.0}, {"now": 0.0}, {"left": 703, "right": -703}, {"angle": -0.19}]
)
def test_a_hurry_is_no_leap(change):
    assert increment_between(START, after(**change)) is not None


@given(st.integers(-50000, 50000), st.integers(0, 0xFFFF), st.integers(0, 0xFFFF), st.floats(-math.pi, math.pi))
def test_no_step_is_faster_than_a_kobuki_can_be(ms, left, right, angle):
    try:
        step = increment_between(START, after(ms, left, right, angle))
    except Discontinuity:
        return
    assume(step is not None)
    assert 0.0 < step.seconds <= 0.5
    assert abs(step.distance) <= 1.5 * (step.seconds + 0.02)
    assert abs(step.turn) <= 5.0 * (step.seconds + 0.02)
