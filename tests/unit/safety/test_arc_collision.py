"""The closed form of a disc on an arc, against the disc moved in small steps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.safety.arc_collision import first_contact, safe_speed
from cliffscan.safety.pending_motion import SLOW, PendingMotion

RADIUS = 0.21
STEP = 0.001  # [m]

points = st.lists(st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5)), min_size=1, max_size=6)
speeds = st.one_of(st.floats(0.05, 0.7), st.floats(-0.7, -0.05))


def driven(points, linear, angular, radius=RADIUS, clearance=None):
    """The free distance of a velocity; nothing is near already."""
    side = 1 if linear > 0 else -1
    return first_contact(points, side, angular / linear, radius, radius if clearance is None else clearance).distance


def moved(points, linear, angular, longest):
    """Distance [m] at which a disc, moved in steps, first covers a point; inf if not within `longest`."""
    distances = np.arange(0.0, longest, STEP)
    turned = np.abs(distances / linear) * angular
    along = np.copysign(distances, linear)
    x = along * np.sinc(turned / 2 / math.pi) * np.cos(turned / 2)
    y = along * np.sinc(turned / 2 / math.pi) * np.sin(turned / 2)
    hit = [(np.hypot(x - px, y - py) < RADIUS).nonzero()[0] for px, py in points]
    return min((distances[each[0]] for each in hit if len(each)), default=math.inf)


@given(points, speeds, st.one_of(st.just(0.0), st.floats(-1.9, 1.9)))
def test_it_is_the_disc_moved_along_the_arc(where, linear, angular):
    outside = [point for point in where if math.hypot(*point) > RADIUS + 2 * STEP]
    longest = min(1.5, abs(1.9 * math.pi * linear / angular) if abs(angular) > 1e-9 else 1.5)
    array = np.array(outside).reshape(-1, 2).T
    found = driven(array, linear, angular)
    slow = moved(outside, linear, angular, longest)
    if slow < math.inf:
        assert found <= slow + 1e-9
        assert moved(outside, linear, angular, slow + STEP) == slow
    if found < longest - STEP:  # a point that is only grazed may slip between two steps
        grown = driven(array, linear, angular, RADIUS - 2 * STEP)
        assert slow <= max(grown, found) + 2 * STEP or grown == math.inf


@pytest.mark.parametrize("linear", [0.2, -0.2])
@pytest.mark.parametrize(
    ("x", "y", "angular", "expected"),
    [(1.0, 0.0, 0.0, 0.79), (1.0, 0.2099, 0.0, 0.99352), (1.0, 0.211, 0.0, math.inf), (-1.0, 0.0, 0.0, math.inf)],
)
def test_straight_ahead_and_straight_back(linear, x, y, angular, expected):
    point = np.array([[math.copysign(1, linear) * x], [y]])
    assert driven(point, linear, angular) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(
    ("linear", "x", "expected"), [(1, 0.1, 0), (1, -0.1, math.inf), (-1, -0.1, 0), (-1, 0.1, math.inf)]
)
def test_what_is_inside_the_disc_blocks_only_the_way_towards_it(linear, x, expected):
    assert driven(np.array([[x], [0.0]]), linear, 0.0) == expected


@pytest.mark.parametrize("linear", [0.3, -0.3])
def test_an_arc_that_leads_away_from_what_is_near_leads_back_to_it(linear):
    x = -math.copysign(0.05, linear)
    found = driven(np.array([[x], [0.15]]), linear, abs(linear) / 0.1 * math.copysign(1.0, linear))
    assert found == pytest.approx(0.1 * math.pi / 2)  # at 225° of its circle, it is as near again at 90°


def test_what_is_passed_at_the_clearance_is_not_in_the_way_and_what_is_met_is_kept_the_whole_radius_away():
    wall = np.stack([np.arange(-1.0, 1.0, 0.04), np.full(50, 0.19)])
    assert driven(wall, 0.3, 0.0, clearance=0.19) == math.inf
    assert driven(wall, 0.3, -0.1, clearance=0.19) == math.inf
    assert driven(wall, 0.3, 0.1, clearance=0.19) == pytest.approx(0.0)
    assert driven(np.array([[1.0], [0.18]]), 0.3, 0.0, clearance=0.19) < 1.0 - 0.1


def test_nothing_is_in_the_way_of_nothing():
    assert driven(np.empty((2, 0)), 0.3, 0.2) == math.inf
    assert driven(np.empty((2, 0)), 0.3, 0.0) == math.inf


@given(st.floats(0, 5), st.floats(0.1, 3), st.floats(0, 1))
def test_safe_speed_is_the_inverse_of_the_stopping_distance(distance, deceleration, latency):
    speed = safe_speed(distance, deceleration, latency)
    assert speed >= 0.0
    assert speed * latency + speed**2 / (2 * deceleration) == pytest.approx(distance, abs=1e-9)
    assert safe_speed(-distance, deceleration, latency) == 0.0


def test_a_speed_lasts_for_the_delay_and_then_as_long_as_braking_takes():
    pending = PendingMotion(0.25, 0.6, 2.6)
    pending.send(0.6, 0.0, 1.0)
    for tick in range(1, 100):
        now = 1.0 + 0.02 * tick
        pending.send(0.0, 0.0, now)
        braked = 0.6 - 0.6 * max(now - 1.02 - 0.25, 0.0)
        assert max(braked, 0.0) - 1e-9 <= pending.speed(1, now) <= max(braked, 0.0) + 0.6 * 0.021
        assert pending.speed(-1, now) == 0.0
    pending.rest()
    assert pending.speed(1, 9.0) == 0.0


def test_the_last_velocity_lasts_until_another_is_sent():
    pending = PendingMotion(0.25, 0.6, 2.6)
    pending.send(-0.3, 0.0, 1.0)
    assert pending.speed(-1, 50.0) == 0.3


def test_a_steady_arc_is_one_arc_and_a_swerve_is_a_fan():
    pending = PendingMotion(0.25, 0.6, 2.6)
    pending.send(0.5, 0.5, 1.0)
    assert pending.curvatures(1, 0.4, 0.4, 1.02) == [1.0]
    swerve = pending.curvatures(1, 0.5, -0.5, 1.02)
    assert swerve[0] == -1.0
    assert min(swerve) == pytest.approx(-1.0)
    assert max(swerve) == pytest.approx(1.0)
    turn = pending.curvatures(1, 0.0, 1.0, 1.02)
    assert max(turn) == pytest.approx(1.0 / SLOW)
