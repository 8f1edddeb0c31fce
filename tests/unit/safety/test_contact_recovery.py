"""Backing off: where to, how far, and when not."""

import math

import numpy as np
import pytest

from cliffscan.safety.contact_recovery import AWAY, BACK, LONGEST, ContactRecovery, touched
from cliffscan.safety.hull import Disc
from cliffscan.safety.pose2d import Pose2D
from tests.gate_drive import contacts

START = Pose2D(1.0, 2.0, 0.5)


def behind(distance):
    """The pose [m] behind START."""
    return START.then(Pose2D(-distance, 0.0, 0.0))


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
@pytest.mark.parametrize(
    ("bits", "side", "angular"),
    [(1, "right", AWAY), (2, "centre", 0), (4, "left", -AWAY), (5, "centre", 0), (3, "centre", 0), (7, "centre", 0)],
)
def test_it_backs_off_and_turns_away(kind, bits, side, angular):
    reaction = ContactRecovery().update(contacts(**{kind: bits}), START)
    assert reaction.hit == (kind, side)
    assert (reaction.linear, reaction.angular) == (BACK, angular)
    assert reaction.pressed


def test_a_cliff_comes_before_a_bumper():
    assert ContactRecovery().update(contacts(bumper=4, cliff=1), START).hit == ("cliff", "right")


def test_nothing_happens_without_a_hit():
    assert ContactRecovery().update(contacts(), START) is None
    assert ContactRecovery().update(contacts(drop=1), START) is None


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
def test_it_goes_on_after_the_release_but_0_10_m_at_most(kind):
    recovery = ContactRecovery()
    for millimetres in range(70):
        assert recovery.update(contacts(**{kind: 2}), behind(millimetres / 1000))
    went = next(d for d in range(70, 200) if recovery.update(contacts(), behind(d / 1000)) is None) - 69
    overshoot = abs(BACK) * 0.2 + BACK**2 / 1.2  # [m] dead time and braking
    assert 0.02 <= went / 1000 <= 0.10 - overshoot


def test_only_what_is_pressed_is_pressed():
    recovery = ContactRecovery()
    recovery.update(contacts(bumper=1), START)
    after = recovery.update(contacts(), behind(0.01))
    assert after.hit == ("bumper", "right")
    assert not after.pressed


@pytest.mark.parametrize("first", [{"bumper": 2}, {"cliff": 2}, {"cliff": 4}])
@pytest.mark.parametrize("second", [{"cliff": 1}, {"drop": 1}, {"drop": 2}])
def test_a_cliff_or_a_wheel_drop_on_the_way_back_stops_it_until_all_is_released(first, second):
    recovery = ContactRecovery()
    for millimetres in range(20):
        assert recovery.update(contacts(**first), behind(millimetres / 1000)).linear == BACK
    for sensors in (second, {**first, **second}, first):
        assert recovery.update(contacts(**sensors), behind(0.02))[1:3] == (0.0, 0.0)
    assert recovery.update(contacts(), behind(0.02)) is None
    assert recovery.update(contacts(), behind(0.02)) is None


def test_a_cliff_right_after_a_bumper_stops_it_at_once():
    recovery = ContactRecovery()
    recovery.update(contacts(bumper=2), START)
    assert recovery.update(contacts(bumper=2, cliff=1), START).linear == 0.0


def test_the_same_cliff_again_on_the_way_back_stops_it():
    recovery = ContactRecovery()
    recovery.update(contacts(cliff=2), START)
    assert recovery.update(contacts(cliff=2), behind(0.02)).linear == BACK
    assert recovery.update(contacts(), behind(0.03)).linear == BACK
    assert recovery.update(contacts(cliff=2), behind(0.04)).linear == 0.0


def test_a_second_sensor_of_the_same_edge_while_it_still_rolls_forward_does_not_stop_it():
    recovery = ContactRecovery()
    recovery.update(contacts(cliff=4), START)
    reaction = recovery.update(contacts(cliff=6), behind(-0.05))
    assert (reaction.linear, reaction.angular) == (BACK, 0.0)
    assert recovery.update(contacts(cliff=6), behind(-0.06)).linear == BACK
    assert recovery.update(contacts(cliff=6), behind(0.0)).linear == BACK
    assert recovery.update(contacts(cliff=7), behind(0.0)).linear == 0.0


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
def test_a_sensor_that_never_lets_go_does_not_send_it_back_for_ever(kind):
    recovery = ContactRecovery()
    recovery.update(contacts(**{kind: 2}), START)
    assert recovery.update(contacts(**{kind: 2}), behind(LONGEST - 0.01)).linear == BACK
    assert recovery.update(contacts(**{kind: 2}), behind(LONGEST + 0.01)).linear == 0.0
    assert recovery.update(contacts(**{kind: 2}), behind(LONGEST + 0.01)).linear == 0.0
    assert recovery.update(contacts(), behind(LONGEST + 0.01)) is None


def test_clear_forgets():
    recovery = ContactRecovery()
    recovery.update(contacts(bumper=2), START)
    recovery.clear()
    assert recovery.update(contacts(), START) is None


@pytest.mark.parametrize(("bits", "bearing"), [(4, 50), (2, 0), (1, -50)])
def test_what_was_touched_is_on_the_rim_where_the_sensor_is(bits, bearing):
    hit = ContactRecovery().update(contacts(bumper=bits), START).hit
    x, y = START.from_world(touched(hit, START, Disc(0.18)))
    assert np.hypot(x, y) == pytest.approx(0.18)
    assert math.degrees(math.atan2(y[2], x[2])) == pytest.approx(bearing)
