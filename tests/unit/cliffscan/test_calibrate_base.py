"""What is made of the stops of a base: every one of them is covered by what is printed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.calibrate import NotMeasured
from cliffscan.calibrate_base import Brakes, Stop, brakes_of, fastest_on, lines
from cliffscan.cli import build_parser

SPEEDS = (0.25, -0.25, 0.375, -0.375, 0.5, -0.5)


def stops(late, deceleration, errors=(0.0,) * 6):
    return [
        Stop(abs(v), abs(v) * late + v * v / (2 * deceleration) + error)
        for v, error in zip(SPEEDS, errors, strict=True)
    ]


@given(st.floats(0.02, 0.5), st.floats(0.3, 2.0), st.lists(st.floats(-0.003, 0.003), min_size=6, max_size=6))
def test_no_measured_stop_is_longer_than_the_gate_takes_it_for(late, deceleration, errors):
    measured = stops(late, deceleration, errors)
    try:
        brakes = brakes_of(measured)
    except NotMeasured:
        return
    for speed, way in measured:
        assert way <= speed * brakes.reaction + speed**2 / (2 * brakes.deceleration) + 1e-9


def test_exact_stops_give_the_base_they_are_of():
    brakes = brakes_of(stops(0.2, 0.8))
    assert brakes.deceleration == pytest.approx(0.76)
    assert 0.2 < brakes.reaction < 0.26


def test_ways_that_do_not_grow_are_no_measure():
    with pytest.raises(NotMeasured, match="drive faster"):
        brakes_of([Stop(0.25, 0.2), Stop(0.5, 0.2), Stop(0.75, 0.2)])


@given(st.floats(0.5, 5.0), st.floats(0.1, 2.0))
def test_a_slow_base_keeps_to_the_free_floor(free, most):
    speed = fastest_on(free, most)
    assert 0.0 < speed <= most
    assert speed**2 / (2 * 0.5) + speed * (0.3 + 0.35) + speed**2 / (2 * 0.4) <= free - 0.1 + 1e-9


def test_the_lines_are_rounded_to_the_safe_side():
    assert lines("gate", Brakes(0.2112, 0.7689), Brakes(0.1, np.radians(171.9))).splitlines() == [
        "[gate]",
        "deceleration = 0.76  # [m/s²]",
        "angular_deceleration = 171  # [deg/s²]",
        "reaction = 0.22  # [s] straight 0.21, turning 0.10",
    ]


@pytest.mark.parametrize(("words", "role"), [([], ""), (["--role", "driver"], "driver")])
def test_the_keys_follow_from_what_is_measured_unless_named(words, role):
    assert build_parser().parse_args(["calibrate", *words]).role == role
