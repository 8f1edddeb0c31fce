"""Combining never hides an obstacle, and never makes free what somebody did not see."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.combine import beams_with, combine, within
from tests import naive

INF, NAN = math.inf, math.nan
ranges = st.floats(0, 50, width=32) | st.sampled_from([INF, NAN, 1.0, 2.0])


def scans(least=1, most=5):
    """Several scans of as many beams; scan k rests on evidence k."""
    return st.integers(1, 12).flatmap(
        lambda beams: st.lists(st.lists(ranges, min_size=beams, max_size=beams), min_size=least, max_size=most).map(
            lambda rows: [beams_with(np.array(row, np.float32), k + 1) for k, row in enumerate(rows)]
        )
    )


def beams(*values, evidence=1):
    return beams_with(np.array(values, np.float32), evidence)


def clear_to(scan, metres):
    return scan.model_copy(update={"clear": np.float32(metres)})


@pytest.mark.parametrize(
    ("one", "other", "result"),
    [
        (1.0, 2.0, 1.0),
        (2.0, 1.0, 1.0),
        (INF, 2.0, 2.0),
        (NAN, 2.0, 2.0),
        (INF, INF, INF),
        (NAN, INF, NAN),
        (INF, NAN, NAN),
        (NAN, NAN, NAN),
        (0.0, INF, 0.0),
    ],
)
def test_two_beams(one, other, result):
    assert_array_equal(combine([beams(one), beams(other)]).ranges, np.float32([result]))


def test_floor_is_clear_as_far_as_all_scans_allow():
    follows = clear_to(beams(2.0, INF, NAN, NAN), [1.5, 3.5, 1.0, 1.2])
    assert_array_equal(combine([follows, beams(1.0, INF, 2.0, NAN)]).clear, np.float32([1.0, 3.5, 1.0, 0.0]))
    assert_array_equal(combine([beams(5.0, 5.0, 0.5, INF), follows]).clear, np.float32([1.5, 3.5, 0.5, 1.2]))


def test_nobody_tells_how_far_floor_is_clear_if_no_scan_does():
    assert not len(combine([beams(1.0), beams(INF)]).clear)
    assert not len(within(combine([beams(1.0), beams(INF)]), 0.5).clear)


def test_floor_is_not_told_to_be_clear_beyond_range_max():
    follows = clear_to(beams(2.0, INF), [1.5, 3.5])
    assert_array_equal(within(follows, 3.0).clear, np.float32([1.5, 3.0]))


@given(scans())
def test_no_obstacle_is_hidden(inputs):
    found = combine(inputs).ranges
    for scan in inputs:
        seen = np.isfinite(scan.ranges)
        assert (found[seen] <= scan.ranges[seen]).all()


@given(scans())
def test_no_obstacle_is_made_up(inputs):
    found = combine(inputs).ranges
    for beam in np.flatnonzero(np.isfinite(found)):
        assert found[beam] in [scan.ranges[beam] for scan in inputs]


@given(scans())
def test_a_beam_is_free_only_where_all_looked(inputs):
    free = np.isposinf(combine(inputs).ranges)
    assert_array_equal(free, np.all([np.isposinf(scan.ranges) for scan in inputs], axis=0))


@given(scans())
def test_the_evidence_is_that_of_the_first_of_the_nearest(inputs):
    found = combine(inputs)
    for beam, (distance, evidence) in enumerate(zip(found.ranges, found.intensities, strict=True)):
        having = [scan.intensities[beam] for scan in inputs if scan.ranges[beam] == distance]
        assert evidence == (having[0] if np.isfinite(distance) else Evidence.NOTHING)


@given(scans(2))
def test_the_order_does_not_matter_to_the_ranges(inputs):
    assert_array_equal(combine(inputs).ranges, combine(inputs[::-1]).ranges)


@given(scans(3))
def test_it_does_not_matter_what_is_combined_first(inputs):
    one, *others = inputs
    assert_array_equal(combine([one, combine(others)]).ranges, combine(inputs).ranges)
    *others, last = inputs
    assert_array_equal(combine([combine(others), last]).ranges, combine(inputs).ranges)


@given(scans(1, 1))
def test_one_scan_stays_as_it_is(inputs):
    (scan,) = inputs
    for found in (combine([scan]), combine([scan, scan])):
        assert_array_equal(found.ranges, scan.ranges)
        assert_array_equal(found.intensities, scan.intensities)


@given(scans(2, 2))
def test_it_is_the_papers(inputs):
    one, other = (scan.ranges for scan in inputs)
    assert_array_equal(combine(inputs).ranges, naive.combine(one, other))


@given(scans())
def test_the_numbers_stay_single_precision_and_the_inputs_as_they_are(inputs):
    before = [scan.ranges.copy() for scan in inputs]
    found = combine(inputs)
    assert found.ranges.dtype == found.intensities.dtype == np.float32
    for scan, ranges_before in zip(inputs, before, strict=True):
        assert_array_equal(scan.ranges, ranges_before)


def test_there_is_evidence_where_there_is_a_number():
    assert_array_equal(beams(1, INF, NAN, 0, evidence=4).intensities, [4, 0, 0, 4])
