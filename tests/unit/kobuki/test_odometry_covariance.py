"""How sure the odometry says it is: the figures of its model, and no surer than it can be."""

import math

import pytest

from tests.kobuki_base import Base


def deviations(covariance):
    return math.sqrt(covariance.xx), math.sqrt(covariance.yy), math.sqrt(covariance.tt)


def test_how_sure_a_metre_is():
    covariance = Base().drive(0.25, 0.0, 4).pose_covariance
    assert math.sqrt(covariance.xx) == pytest.approx(0.01, rel=0.01)
    assert math.sqrt(covariance.tt) == pytest.approx(2e-3, rel=0.01)
    assert math.sqrt(covariance.yy) == pytest.approx(2e-3 / math.sqrt(3), rel=0.01)  # from the heading alone
    assert covariance.yt > 0


def test_how_sure_a_metre_without_a_gyro_is():
    covariance = Base(with_gyro=False).drive(0.25, 0.0, 4).pose_covariance
    assert math.degrees(math.sqrt(covariance.tt)) == pytest.approx(1.81, rel=0.05)


@pytest.mark.parametrize(("with_gyro", "degrees"), [(True, 1.44), (False, 10.2)])
def test_how_sure_a_full_turn_is(with_gyro, degrees):
    covariance = Base(with_gyro=with_gyro).drive(0.0, math.tau / 10, 10).pose_covariance
    assert math.degrees(math.sqrt(covariance.tt)) == pytest.approx(degrees, rel=0.03)


@pytest.mark.parametrize(("silence", "metres"), [(2.0, 0.7), (60.0, 1.05)])
def test_how_sure_a_silence_is(silence, metres):
    base = Base()
    base.report()
    base.move(0.0, 0.0, silence)
    spread = deviations(base.report().pose_covariance)
    assert spread == pytest.approx((metres, metres, metres / 0.35 * 0.5))


def test_the_twist_is_as_sure_as_its_rounding_and_its_speed():
    at_rest = deviations(Base().drive(0.0, 0.0, 1).twist_covariance)
    assert at_rest == pytest.approx((0.00123, 0.01, 0.00356), rel=0.01)
    blind = deviations(Base(with_gyro=False).drive(0.0, 0.0, 1).twist_covariance)
    assert blind == pytest.approx((0.00123, 0.01, 0.0107), rel=0.01)
    fast = deviations(Base().drive(0.5, 1.0, 1).twist_covariance)
    assert fast == pytest.approx((0.0101, 0.01, 0.0106), rel=0.05)
    slipping = deviations(Base(with_gyro=False).drive(0.0, 1.0, 1).twist_covariance)
    assert slipping[2] == pytest.approx(0.051, rel=0.05)


def test_before_the_first_step_it_may_be_as_fast_as_it_can_be():
    assert deviations(Base().report().twist_covariance) == pytest.approx((0.7, 0.01, 2.0))
