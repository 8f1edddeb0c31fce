"""Backing off: where to, how far, and when not."""

import math

import numpy as np
import pytest

from cliffscan.safety.contact_recovery import AWAY, BACK, LONGEST, Reflex, touched
from cliffscan.safety.local_grid import Pose
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import core

START = Pose(1.0, 2.0, 0.5)


def sensed(**sensors):
    return decode(core(**sensors)).core


def behind(distance):
    """The pose [m] behind START."""
    return START.then(Pose(-distance, 0.0, 0.0))


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
@pytest.mark.parametrize(
    ("bits", "side", "angular"),
    [(1, "right", AWAY), (2, "centre", 0), (4, "left", -AWAY), (5, "centre", 0), (3, "centre", 0), (7, "centre", 0)],
)
def test_it_backs_off_and_turns_away(kind, bits, side, angular):
    reaction = Reflex().update(sensed(**{kind: bits}), START)
    assert reaction.hit == (kind, side)
    assert (reaction.linear, reaction.angular) == (BACK, angular)
    assert reaction.pressed


def test_a_cliff_comes_before_a_bumper():
    assert Reflex().update(sensed(bumper=4, cliff=1), START).hit == ("cliff", "right")


def test_nothing_happens_without_a_hit():
    assert Reflex().update(sensed(), START) is None
    assert Reflex().update(sensed(drop=1), START) is None


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
def test_it_goes_on_after_the_release_but_0_10_m_at_most(kind):
    reflex = Reflex()
    for millimetres in range(70):
        assert reflex.update(sensed(**{kind: 2}), behind(millimetres / 1000))
    went = next(d for d in range(70, 200) if reflex.update(sensed(), behind(d / 1000)) is None) - 69
    overshoot = abs(BACK) * 0.2 + BACK**2 / 1.2  # [m] dead time and braking
    assert 0.02 <= went / 1000 <= 0.10 - overshoot


def test_only_what_is_pressed_is_pressed():
    reflex = Reflex()
    reflex.update(sensed(bumper=1), START)
    after = reflex.update(sensed(), behind(0.01))
    assert after.hit == ("bumper", "right")
    assert not after.pressed


@pytest.mark.parametrize("first", [{"bumper": 2}, {"cliff": 2}, {"cliff": 4}])
@pytest.mark.parametrize("second", [{"cliff": 1}, {"drop": 1}, {"drop": 2}])
def test_a_cliff_or_a_wheel_drop_on_the_way_back_stops_it_until_all_is_released(first, second):
    reflex = Reflex()
    for millimetres in range(20):
        assert reflex.update(sensed(**first), behind(millimetres / 1000)).linear == BACK
    for sensors in (second, {**first, **second}, first):
        assert reflex.update(sensed(**sensors), behind(0.02))[1:3] == (0.0, 0.0)
    assert reflex.update(sensed(), behind(0.02)) is None
    assert reflex.update(sensed(), behind(0.02)) is None


def test_a_cliff_right_after_a_bumper_stops_it_at_once():
    reflex = Reflex()
    reflex.update(sensed(bumper=2), START)
    assert reflex.update(sensed(bumper=2, cliff=1), START).linear == 0.0


def test_the_same_cliff_again_on_the_way_back_stops_it():
    reflex = Reflex()
    reflex.update(sensed(cliff=2), START)
    assert reflex.update(sensed(cliff=2), behind(0.02)).linear == BACK
    assert reflex.update(sensed(), behind(0.03)).linear == BACK
    assert reflex.update(sensed(cliff=2), behind(0.04)).linear == 0.0


def test_a_second_sensor_of_the_same_edge_while_it_still_rolls_forward_does_not_stop_it():
    reflex = Reflex()
    reflex.update(sensed(cliff=4), START)
    reaction = reflex.update(sensed(cliff=6), behind(-0.05))
    assert (reaction.linear, reaction.angular) == (BACK, 0.0)
    assert reflex.update(sensed(cliff=6), behind(-0.06)).linear == BACK
    assert reflex.update(sensed(cliff=6), behind(0.0)).linear == BACK
    assert reflex.update(sensed(cliff=7), behind(0.0)).linear == 0.0


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
def test_a_sensor_that_never_lets_go_does_not_send_it_back_for_ever(kind):
    reflex = Reflex()
    reflex.update(sensed(**{kind: 2}), START)
    assert reflex.update(sensed(**{kind: 2}), behind(LONGEST - 0.01)).linear == BACK
    assert reflex.update(sensed(**{kind: 2}), behind(LONGEST + 0.01)).linear == 0.0
    assert reflex.update(sensed(**{kind: 2}), behind(LONGEST + 0.01)).linear == 0.0
    assert reflex.update(sensed(), behind(LONGEST + 0.01)) is None


def test_clear_forgets():
    reflex = Reflex()
    reflex.update(sensed(bumper=2), START)
    reflex.clear()
    assert reflex.update(sensed(), START) is None


@pytest.mark.parametrize(("bits", "bearing"), [(4, 50), (2, 0), (1, -50)])
def test_what_was_touched_is_on_the_rim_where_the_sensor_is(bits, bearing):
    hit = Reflex().update(sensed(bumper=bits), START).hit
    x, y = START.from_world(touched(hit, START, 0.18))
    assert np.hypot(x, y) == pytest.approx(0.18)
    assert math.degrees(math.atan2(y[2], x[2])) == pytest.approx(bearing)
