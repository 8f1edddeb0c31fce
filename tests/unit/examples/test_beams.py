"""Numbers, +inf and NaN mean what REP-117 says."""

import numpy as np
import pytest

from examples.slam.beams import beams
from examples.slam.wire import read_scan
from tests.unit.examples.room import payload, scan_fields

REACH = 4.0


def said(value, evidence=1.0, **changes):
    """How far a beam of this range tells the ground to be free, and whether it hit; then it ends there."""
    seen = beams(read_scan(payload(scan_fields([value], [evidence]) | changes)), REACH)
    assert not seen.hit[0] or seen.ends[0] == value
    return seen.free[0], bool(seen.hit[0])


@pytest.mark.parametrize("evidence", [1.0, 2.0, 3.0, 4.0, 5.0])
def test_a_number_is_free_ground_up_to_something(evidence):
    assert said(1.5, evidence) == (1.5, True)


def test_without_intensities_a_number_is_an_obstacle():
    assert said(1.5, intensities=b"") == (1.5, True)


def test_a_number_without_evidence_is_free_ground_only():
    assert said(1.5, 0.0) == (1.5, False)


def test_inf_is_free_up_to_the_reach():
    assert said(np.inf, 0.0) == (REACH, False)


def test_inf_promises_no_more_than_the_scan_reaches():
    assert said(np.inf, 0.0, range_max=2.0) == (2.0, False)


def test_beyond_the_reach_it_is_free_up_to_there():
    assert said(4.25) == (REACH, False)


@pytest.mark.parametrize(
    ("value", "clear", "free"),
    [(1.5, 1.25, 1.25), (1.5, 2.0, 1.5), (np.inf, 3.5, 3.5), (np.nan, 0.75, 0.75), (1.5, 0, 0)],
)
def test_a_scan_that_tells_how_far_it_saw_floor_is_believed(value, clear, free):
    assert said(value, clear=np.float32([clear]).tobytes()) == (free, bool(np.isfinite(value)))


@pytest.mark.parametrize("value", [np.nan, 4.75, -1.0, -np.inf])
def test_nan_and_what_lies_outside_the_limits_say_nothing(value):
    assert said(value) == (0.0, False)


def test_too_near_to_be_measured_says_nothing():
    assert said(0.25, range_min=0.5) == (0.0, False)
