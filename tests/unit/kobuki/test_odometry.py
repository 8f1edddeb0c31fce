"""The pose goes where the wheels go, never jumps, and is never surer than it can be."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.services.kobuki.odometry import UNKNOWN_TWIST, Odometry
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_base import PERIOD, WHEELS_APART, Base
from tests.kobuki_stream import core, inertia


@pytest.fixture(params=[True, False], ids=["gyro", "wheels"])
def base(request):
    """A base all of whose counters are about to wrap."""
    return Base(65400, (65500, 65000), math.radians(179.5), with_gyro=request.param)


def wrapped(angle):
    return math.remainder(angle, math.tau)


def matrix(covariance):
    return np.reshape(covariance.rows(), (3, 3))


def test_the_first_packet_is_the_baseline():
    estimate = Base(5000, (1234, 4321), 1.0).report()
    assert estimate.pose == (0, 0, 0)
    assert estimate.twist == (0, 0)
    assert estimate.new_baseline == "first packet"
    assert not any(estimate.pose_covariance)


def test_a_straight_line(base):
    estimate = base.drive(0.3, 0.0, 10)
    assert estimate.pose == pytest.approx((3.0, 0.0, 0.0), abs=2e-3)
    assert estimate.twist == pytest.approx((0.3, 0.0), abs=0.04)
    assert estimate.new_baseline is None


def test_backwards(base):
    assert base.drive(-0.3, 0.0, 2).pose == pytest.approx((-0.6, 0.0, 0.0), abs=2e-3)


def test_a_full_circle(base):
    radius, angular = 0.5, 0.6
    base.report()
    xs, ys = zip(
        *(base.drive(radius * angular, angular, PERIOD).pose[:2] for _ in range(round(math.tau / angular / PERIOD))),
        strict=True,
    )
    assert (min(xs), max(xs)) == pytest.approx((-radius, radius), abs=5e-3)
    assert (min(ys), max(ys)) == pytest.approx((0.0, 2 * radius), abs=8e-3)
    assert base.report().pose == pytest.approx((0.0, 0.0, 0.0), abs=0.02)


@pytest.mark.parametrize("angular", [-1.5, 1.5])
def test_turning_on_the_spot_for_hours(base, angular):
    estimate = base.drive(0.0, angular, 60)
    assert estimate.pose[:2] == pytest.approx((0.0, 0.0), abs=1e-3)
    assert wrapped(estimate.pose[2] - 60 * angular) == pytest.approx(0.0, abs=2e-3)
    assert estimate.twist == pytest.approx((0.0, angular), abs=0.05)


def test_the_gyro_is_believed_rather_than_slipping_wheels():
    base = Base()
    base.report()
    for _ in range(50):
        base.move(0.0, 1.0)
        base.left -= 0.5 * WHEELS_APART / 2 * PERIOD
        estimate = base.report()
    assert estimate.pose[2] == pytest.approx(1.0, abs=1e-3)


def test_the_wheels_step_in_while_the_gyro_is_silent():
    base = Base(angle=3.0)
    base.drive(0.2, 1.0, 1)
    base.with_gyro = False
    base.drive(0.2, 1.0, 1)
    base.with_gyro = True
    estimate = base.drive(0.2, 1.0, 1)
    assert estimate.pose[2] == pytest.approx(3.0, abs=5e-3)
    assert estimate.new_baseline is None


def test_an_arc_is_taken_along_its_middle():
    base = Base(with_gyro=False)
    base.report()
    base.move(0.5, 1.0, 0.4)
    x, y, theta = base.report().pose
    assert theta == pytest.approx(0.4, abs=1e-3)
    assert math.atan2(y, x) == pytest.approx(0.2, abs=1e-3)


def test_a_few_lost_packets_cost_nothing(base):
    base.report()
    base.move(0.5, 0.0, 0.3)
    estimate = base.report()
    assert estimate.pose == pytest.approx((0.15, 0.0, 0.0), abs=1e-3)
    assert estimate.twist == pytest.approx((0.5, 0.0), abs=1e-2)


def test_packets_that_come_in_a_burst_are_all_counted(base):
    """Our own clock may stand still between packets; it is the base's that counts."""
    base.drive(0.4, 0.0, 1)
    now = base.now
    for n in range(20):
        base.move(0.4, 0.0)
        base.now = now + (0.4 if n else 0.0)
        estimate = base.report()
        assert estimate.new_baseline is None
    assert estimate.pose[0] == pytest.approx(0.56, abs=1e-3)
    assert estimate.twist[0] == pytest.approx(0.4, abs=0.02)


def test_a_packet_told_twice_changes_nothing(base):
    before = base.drive(0.4, 0.0, 1)
    assert base.report() is not None
    again = base.report()
    assert (again.pose, again.twist) == (before.pose, before.twist)


def test_motion_under_a_stuck_clock_is_not_lost():
    base = Base()
    base.report()
    base.move(0.4, 0.0)
    base.clock -= PERIOD
    assert base.report().pose == (0, 0, 0)
    base.move(0.4, 0.0)
    assert base.report().pose[0] == pytest.approx(0.016, abs=2e-4)


INTERRUPTIONS = {
    "power cycle": lambda base: base.power_cycle(),
    "power cycle to anything": lambda base: base.power_cycle(44444, (9999, 40000), -2.0),
    "lost for long": lambda base: base.move(0.5, 1.0, 3.0),
    "lost for a round of the clock": lambda base: base.move(0.0, 0.1, 65.536),
    "lost for more than half a round": lambda base: base.move(0.1, 0.0, 35.0),
    "encoders leap": lambda base: base.power_cycle(1000 * base.clock, (5000, 5000), base.angle),
    "port opened anew": lambda base: (base.odometry.rebaseline("port opened anew"), base.move(0.3, 0.3, 0.4)),
}


@pytest.mark.parametrize("interruption", INTERRUPTIONS)
def test_an_interruption_leaves_the_pose_where_it_was(base, interruption):
    before = base.drive(0.3, 0.4, 2)
    INTERRUPTIONS[interruption](base)
    base.move(0.3, 0.4)
    after = base.report()
    assert after.pose == before.pose
    assert after.new_baseline
    assert after.twist == (0, 0)
    assert after.twist_covariance == UNKNOWN_TWIST
    base.move(0.3, 0.4)
    next_one = base.report()
    assert next_one.new_baseline is None
    assert math.dist(next_one.pose[:2], before.pose[:2]) == pytest.approx(0.3 * PERIOD, abs=2e-4)
    assert wrapped(next_one.pose[2] - before.pose[2]) == pytest.approx(0.4 * PERIOD, abs=2e-3)


def test_the_reason_of_an_interruption_is_told_once():
    base = Base()
    base.drive(0.1, 0.0, 0.1)
    base.odometry.rebaseline("port opened anew")
    base.move(0.1, 0.0)
    assert base.report().new_baseline == "port opened anew"
    assert base.report().new_baseline is None


def test_reset_makes_here_the_origin_heading_included(base):
    base.drive(0.3, 0.7, 2)
    base.odometry.reset()
    estimate = base.report()
    assert estimate.pose == (0, 0, 0)
    assert not any(estimate.pose_covariance)
    assert base.drive(0.3, 0.0, 1).pose == pytest.approx((0.3, 0.0, 0.0), abs=3e-3)


readings = st.tuples(
    st.integers(0, 0xFFFF) | st.integers(0, 100),
    st.integers(0, 0xFFFF) | st.integers(0, 300),
    st.integers(0, 0xFFFF) | st.integers(0, 300),
    st.none() | st.integers(-18000, 18000) | st.integers(-100, 100),
    st.floats(0, 2) | st.just(PERIOD),
)


@given(st.lists(readings, max_size=30))
def test_whatever_comes_the_pose_goes_no_faster_than_a_kobuki(sequence):
    odometry, now, last = Odometry(), 0.0, (0.0, 0.0, 0.0)
    for timestamp, left, right, angle, wait in sequence:
        now += wait
        feedback = decode(core(timestamp, left, right) + (b"" if angle is None else inertia(angle)))
        estimate = odometry.update(feedback.core, feedback.inertia, now)
        assert math.dist(estimate.pose[:2], last[:2]) <= 1.5 * 0.52
        assert -math.pi <= estimate.pose[2] <= math.pi
        last = estimate.pose
        for covariance in map(matrix, (estimate.pose_covariance, estimate.twist_covariance)):
            assert np.isfinite(covariance).all()
            assert np.linalg.eigvalsh(covariance).min() >= -1e-9


@given(st.lists(st.tuples(st.floats(-0.7, 0.7), st.floats(-1.9, 1.9)), max_size=30), st.booleans())
def test_the_pose_gets_less_sure_with_every_step(velocities, with_gyro):
    base = Base(with_gyro=with_gyro)
    heading = base.report().pose_covariance.tt
    area = 0.0
    for linear, angular in velocities:
        base.move(linear, angular)
        covariance = base.report().pose_covariance
        assert covariance.tt >= heading
        assert covariance.xx + covariance.yy >= area
        heading, area = covariance.tt, covariance.xx + covariance.yy
