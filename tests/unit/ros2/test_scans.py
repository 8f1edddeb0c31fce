"""The three scans free nothing that was not seen, whoever reads them, and lose nothing that may be marked."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cliffscan.common.perception.known_ground import CELL, known_ground
from cliffscan.services.ros2.scans import for_clearing, for_marking, for_slam, range_max
from tests.build import scan

INF, NAN = math.inf, math.nan
SLAM_RANGE = 4.0
FREE = np.float32(4.49)  # nothing was hit
NEAREST = 0.72


def one(ranges, clear):
    """What the three scans have in one beam: (slam, marks, clear)."""
    made = scan([ranges], clear=[clear])
    scans = (
        for_slam(made, known_ground(made), SLAM_RANGE),
        for_marking(made, SLAM_RANGE),
        for_clearing(made, known_ground(made), SLAM_RANGE, NEAREST),
    )
    assert all(each.dtype == np.float32 for each in scans)
    return [float(each[0]) for each in scans]


@pytest.mark.parametrize(
    ("what", "ranges", "clear", "expected"),
    [
        ("a wall behind floor", 2.0, 2.0, (2.0, 2.0, 2.0)),
        ("a wall behind floor but for a row", 2.0, 1.96, (2.0, 2.0, 1.96)),
        ("a wall behind a hole nobody could look into", 3.0, 1.2, (NAN, 3.0, 1.15)),
        ("an edge", 1.5, 1.5, (1.5, 1.5, 1.5)),
        ("an edge at the robot's feet", 0.5, 0.5, (0.5, 0.5, NAN)),
        ("an edge before any floor", 0.72, 0.0, (NAN, 0.72, NAN)),
        ("open floor", INF, 4.0, (FREE, NAN, 3.95)),
        ("open floor that was not followed far", INF, 3.0, (NAN, NAN, 2.95)),
        ("nothing seen", NAN, 0.0, (NAN, NAN, NAN)),
        ("nothing seen behind some floor", NAN, 2.0, (NAN, NAN, 1.95)),
        ("a far wall", 4.2, 4.2, (FREE, 4.2, 4.2)),
        ("a far wall, its floor unknown", 4.2, 3.0, (NAN, 4.2, 2.95)),
        ("a wall beyond all of ROS's ranges", 6.0, 6.0, (FREE, NAN, FREE)),
        ("the same, its floor unknown", 6.0, 3.0, (NAN, NAN, 2.95)),
    ],
)
def test_a_beam(what, ranges, clear, expected):
    assert_allclose(one(ranges, clear), expected, rtol=1e-6, err_msg=what)


def test_a_scan_without_clear_is_taken_at_its_word():
    made = scan([2.0, INF, NAN])
    assert_array_equal(for_slam(made, known_ground(made), SLAM_RANGE), np.array([2.0, FREE, NAN], "f4"))
    assert_array_equal(for_clearing(made, known_ground(made), SLAM_RANGE, NEAREST), np.array([2.0, FREE, NAN], "f4"))


def test_a_camera_that_sees_floor_from_farther_away_clears_less():
    far = scan([INF], clear=[0.9])
    assert np.isnan(for_clearing(far, known_ground(far), SLAM_RANGE, nearest_floor=1.0)).all()


BEAMS = st.lists(
    st.tuples(st.one_of(st.just(NAN), st.just(INF), st.floats(0.0, 8.0, width=32)), st.floats(0.0, 8.0, width=32)),
    min_size=1,
    max_size=30,
)


def karto(ranges, slam_range, greatest):
    """How far Karto frees ground along each beam, and where it marks. Source: Karto's OccupancyGrid::AddScan.

    It ignores NaN and infinity; up to its range threshold a number is marked and all before it freed; from there to
    range_max ground is freed up to the threshold.
    """
    number = np.isfinite(ranges) & (ranges < greatest)
    freed = np.where(number, np.minimum(ranges, slam_range), 0.0)
    return freed, np.where(number & (ranges < slam_range), ranges, NAN)


@given(BEAMS, st.floats(1.0, 6.0))
def test_karto_frees_no_ground_that_nobody_saw(beams, slam_range):
    made = scan([ranges for ranges, _ in beams], clear=[clear for _, clear in beams])
    freed, marked = karto(for_slam(made, known_ground(made), slam_range), slam_range, range_max(slam_range))
    assert (freed <= np.maximum(made.clear + CELL + 1e-5, 0.0)).all()
    hit = np.isfinite(marked)
    assert_array_equal(marked[hit], made.ranges[hit])


@given(BEAMS, st.floats(1.0, 6.0))
def test_clearing_goes_no_farther_than_ground_was_seen_and_spares_every_mark(beams, slam_range):
    made = scan([ranges for ranges, _ in beams], clear=[clear for _, clear in beams])
    cleared, marked = for_clearing(made, known_ground(made), slam_range, NEAREST), for_marking(made, slam_range)
    known = np.isfinite(cleared)
    assert (cleared[known] <= made.clear[known]).all()
    assert (cleared[known] >= np.float32(NEAREST)).all()
    both = known & np.isfinite(marked)
    assert (cleared[both] <= marked[both]).all()


@given(BEAMS, st.floats(1.0, 6.0))
def test_marks_are_all_numbers_and_nothing_else(beams, slam_range):
    made = scan([ranges for ranges, _ in beams], clear=[clear for _, clear in beams])
    marked = for_marking(made, slam_range)
    near = made.ranges < np.float32(range_max(slam_range))
    assert_array_equal(marked[near], made.ranges[near])
    assert np.isnan(marked[~near]).all()


def test_ranges_alone_would_free_what_nobody_saw():
    """The model of Karto does see the difference: it frees a hole from the fused ranges, and not from /scan."""
    made = scan([3.0], clear=[1.2])
    assert karto(made.ranges, SLAM_RANGE, 4.5)[0][0] == 3.0
    assert karto(for_slam(made, known_ground(made), SLAM_RANGE), SLAM_RANGE, 4.5)[0][0] == 0.0
