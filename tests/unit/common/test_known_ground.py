"""A scan's known ground and its safe ranges: nothing is freed that nobody saw, nor beside an edge."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.perception.known_ground import (
    BESIDE,
    CELL,
    SAFE_RANGE,
    known_ground,
    least_of,
    safe_ranges,
    safe_scan,
)
from tests.build import scan

INF, NAN = math.inf, math.nan
POSITIVE, DROP, LOST = map(float, (Evidence.POSITIVE, Evidence.DROP, Evidence.FLOOR_LOST))
STEP = BESIDE / 2.5  # two beams to either side are beside one


def fine(ranges, intensities, clear):
    """A scan whose beams lie so close that an edge has neighbours."""
    half = STEP * (len(ranges) - 1) / 2
    return scan(ranges, intensities, clear, angle_min=-half, increment=STEP)


@pytest.mark.parametrize("edge", [DROP, LOST])
def test_ground_beside_an_edge_is_known_no_farther_than_the_edge(edge):
    made = fine([4.0] * 4 + [2.0] + [4.0] * 4, [POSITIVE] * 4 + [edge] + [POSITIVE] * 4, [4.0] * 4 + [2.0] + [4.0] * 4)
    assert list(known_ground(made)) == [0.0, 0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0, 0.0]


def test_an_obstacle_takes_nothing_from_its_neighbours():
    made = fine([4.0] * 4 + [2.0] + [4.0] * 4, [POSITIVE] * 9, [4.0] * 4 + [2.0] + [4.0] * 4)
    assert list(known_ground(made)) == [0.0, 0.0, 4.0, 4.0, 2.0, 4.0, 4.0, 0.0, 0.0]


def test_a_beam_that_ends_at_an_edge_keeps_its_ground():
    """An edge that runs away from the robot is at another distance in each beam."""
    edges = [1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2]
    assert_array_equal(known_ground(fine(edges, [DROP] * 7, edges)), np.float32(edges))


def test_a_scan_without_clear_is_taken_at_its_word():
    assert_array_equal(known_ground(fine([1.0, INF, NAN], [DROP, 0.0, 0.0], [])), np.float32([1.0, INF, 0.0]))


@given(st.lists(st.floats(0.0, 9.0, width=32), min_size=1, max_size=40), st.data())
def test_the_least_in_a_row(values, data):
    count = data.draw(st.integers(1, len(values)))
    found = least_of(np.array(values, np.float32), count)
    assert list(found) == [min(values[first : first + count]) for first in range(len(values) - count + 1)]


@pytest.mark.parametrize(
    ("what", "ranges", "clear", "expected"),
    [
        ("a wall behind floor", 2.0, 2.0, 2.0),
        ("a wall behind floor but for a row", 2.0, 1.96, 2.0),
        ("a wall behind a hole nobody could look into", 3.0, 1.2, NAN),
        ("open floor", INF, 4.0, INF),
        ("open floor that was not followed far", INF, 3.0, NAN),
        ("a far wall", 5.0, 5.0, INF),
        ("a far wall behind unknown ground", 5.0, 3.0, NAN),
        ("nothing seen", NAN, 0.0, NAN),
    ],
)
def test_a_safe_range(what, ranges, clear, expected):
    made = scan([ranges], clear=[clear])
    assert_array_equal(safe_ranges(made, known_ground(made), 4.0), np.float32([expected]), what)


BEAMS = st.lists(
    st.tuples(
        st.one_of(st.just(NAN), st.just(INF), st.floats(0.0, 8.0, width=32)),
        st.floats(0.0, 8.0, width=32),
        st.sampled_from([POSITIVE, DROP, LOST]),
    ),
    min_size=1,
    max_size=30,
)


@given(BEAMS)
def test_a_reader_of_safe_ranges_alone_frees_no_ground_that_nobody_saw(beams):
    """The reader frees all before a number, and for +inf all up to range_max."""
    ranges, clear, evidence = zip(*beams, strict=True)
    evidence = [each if math.isfinite(distance) else 0.0 for each, distance in zip(evidence, ranges, strict=True)]
    made = fine(list(ranges), evidence, list(clear))
    safe = LaserScan.decode(safe_scan(made).encode())
    freed = np.where(np.isnan(safe.ranges), 0.0, np.minimum(safe.ranges, safe.range_max))
    assert (freed <= made.clear + CELL + 1e-5).all()
    assert safe.range_max == SAFE_RANGE
    number = np.isfinite(safe.ranges)
    assert_array_equal(safe.ranges[number], made.ranges[number])
    assert_array_equal(safe.intensities[number], made.intensities[number])
    assert not safe.intensities[~number].any()
