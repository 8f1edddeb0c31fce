"""A fused scan is the nearest of all inputs, and free only where both scans of the camera are."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import LaserScan
from cliffscan.services.fuse.config import ExtraInput
from cliffscan.services.fuse.fusion import GridMismatch, fuse
from cliffscan.services.fuse.pairing import Pair
from tests import naive
from tests.build import scan

INF, NAN = math.inf, math.nan
LIDAR = ExtraInput(key="scan/lidar")
ranges = st.floats(0.125, 12, width=32) | st.sampled_from([INF, NAN])
lists = st.integers(2, 9).flatmap(
    lambda beams: st.lists(st.lists(ranges, min_size=beams, max_size=beams), min_size=3, max_size=3)
)  # of the positive scan, the negative one and a lidar


def fused(positive, negative, lidar=None, **limits):
    """Ranges of what these make together; the lidar has their grid and stands where they do."""
    extras = {"lidar": (LIDAR, scan(lidar, range_max=100.0))} if lidar is not None else {}
    return fuse(Pair(scan(positive, **limits), scan(negative, **limits)), extras)


def test_each_beam_has_the_nearest_and_its_evidence():
    positive, negative = scan([1, 5, INF, NAN], [1, 1, 0, 0]), scan([2, 3, INF, NAN], [4, 2, 0, 0])
    found = fuse(Pair(positive, negative), {})
    assert_array_equal(found.ranges, np.float32([1, 3, INF, NAN]))
    assert_array_equal(found.intensities, [Evidence.POSITIVE, Evidence.DROP, 0, 0])


@given(lists)
def test_it_is_the_papers_third_algorithm(rows):
    positive, negative, _ = rows
    expected = naive.combine(np.float32(positive), np.float32(negative))
    assert_array_equal(fused(positive, negative, range_max=20.0).ranges, expected.astype(np.float32))


def test_it_tells_how_far_floor_was_seen_before_what_stands_behind():
    negative = scan([NAN, INF, 2.0, NAN], clear=[1.2, 3.5, 1.9, 0.8])
    found = fuse(Pair(scan([3.0, 2.0, INF, NAN]), negative), {"lidar": (LIDAR, scan([INF, INF, 1.5, INF]))})
    assert_array_equal(found.ranges, np.float32([3.0, 2.0, 1.5, NAN]))
    assert_array_equal(found.clear, np.float32([1.2, 2.0, 1.5, 0.0]))


def test_it_tells_nothing_of_that_if_no_input_does():
    assert len(fuse(Pair(scan([3.0, INF]), scan([NAN, INF])), {}).clear) == 0


@given(lists)
def test_no_input_hides_an_obstacle_of_another(rows):
    found = fused(*rows, range_max=20.0).ranges
    for ranges in np.float32(rows):
        seen = np.isfinite(ranges)
        assert (found[seen] <= ranges[seen] * (1 + 1e-6)).all()


@given(lists, st.sampled_from([5.0, 20.0]))
def test_a_beam_is_free_only_where_both_scans_of_the_camera_are(rows, range_max):
    """Whatever an extra input says, and however far it sees."""
    positive, negative, lidar = rows
    free = np.isposinf(fused(positive, negative, lidar, range_max=range_max).ranges)
    unseen = np.isnan(np.float32(positive)) | np.isnan(np.float32(negative))
    assert not (free & unseen).any()


def test_a_beam_that_one_scan_did_not_see_is_not_free_for_what_lies_beyond_range_max():
    pair = Pair(scan([NAN, NAN], range_max=5.0), scan([7.0, 4.0], range_max=10.0))
    assert_array_equal(fuse(pair, {}).ranges, np.float32([NAN, 4.0]))


@given(lists)
def test_an_extra_input_that_saw_nothing_changes_nothing(rows):
    positive, negative, _ = rows
    nothing = [NAN, INF] * 4
    assert_array_equal(fused(positive, negative, nothing).ranges, fused(positive, negative).ranges)


def test_an_extra_input_adds_obstacles_with_its_own_evidence():
    found = fused([5, INF, NAN], [INF, INF, INF], [4, 2, 1])
    assert_array_equal(found.ranges, np.float32([4, 2, 1]))
    assert_array_equal(found.intensities, [Evidence.EXTRA] * 3)


def test_a_reading_outside_the_extra_inputs_own_limits_is_none():
    lidar = scan([0.05, 11.0, 3.0], range_min=0.1, range_max=10.0)
    found = fuse(Pair(scan([INF] * 3, range_max=50.0), scan([INF] * 3, range_max=50.0)), {"l": (LIDAR, lidar)})
    assert_array_equal(found.ranges, np.float32([INF, INF, 3]))


def test_of_two_extra_inputs_the_nearest_counts():
    extras = {"a": (LIDAR, scan([3.0, 1.0])), "b": (LIDAR, scan([2.0, 4.0]))}
    assert_array_equal(fuse(Pair(scan([INF] * 2), scan([INF] * 2)), extras).ranges, np.float32([2, 1]))


def test_an_extra_input_is_turned_and_moved_to_its_mount():
    ahead = scan([2.0], angle_min=0.0, increment=0.01)
    beside = ExtraInput(key="scan/left", x=1.0, yaw=math.degrees(0.5))
    found = fuse(Pair(scan([INF] * 5), scan([INF] * 5)), {"l": (beside, ahead)})
    x, y = 1.0 + 2.0 * math.cos(0.5), 2.0 * math.sin(0.5)
    beam = round((math.atan2(y, x) + 0.5) / 0.25)
    assert found.ranges[beam] == pytest.approx(math.hypot(x, y), rel=1e-3)
    assert np.isposinf(np.delete(found.ranges, beam)).all()


def test_a_scan_without_evidence_is_taken_for_what_its_key_says():
    found = fuse(Pair(scan([1, 5, INF]), scan([2, 3, INF])), {})
    assert_array_equal(found.intensities, [Evidence.POSITIVE, Evidence.DROP, Evidence.NOTHING])


def test_no_number_of_an_extra_input_lies_below_the_least_range():
    pair = Pair(scan([INF, 2.0], range_min=0.3), scan([INF, 2.0], range_min=0.3))
    near, far = scan([0.2, INF], range_min=0.05), scan([4.0, 4.0], range_min=0.05)
    found = [fuse(pair, {"l": (LIDAR, lidar)}) for lidar in (near, far)]
    assert_array_equal(found[0].ranges, np.float32([0.2, 2.0]))
    assert [each.range_min for each in found] == [0.0, 0.0]  # a reader may take that of the first scan for all


def test_the_limits_are_those_that_the_scans_of_the_camera_keep():
    positive = scan([1, 4, INF], range_max=5.0, range_min=0.2)
    negative = scan([2, INF, 9], range_max=10.0, range_min=0.1)
    for extras, least in (({}, 0.1), ({"l": (LIDAR, scan([50, 50, 50], range_max=100.0))}, 0.0)):
        found = fuse(Pair(positive, negative), extras)
        assert (found.range_min, found.range_max) == (least, 5.0)
        assert_array_equal(found.ranges, np.float32([1, 4, INF]))
        assert_array_equal(found.intensities, [1, 1, 0])


def test_the_fused_scan_is_of_its_frame_and_its_grid_and_can_be_read():
    positive = scan([1, INF, NAN], seq=8, stamp=99)
    found = fuse(Pair(positive, scan([2, INF, 3], seq=8, stamp=99)), {})
    for name in ("seq", "stamp", "frame", "angle_min", "angle_max", "angle_increment", "scan_time"):
        assert getattr(found, name) == getattr(positive, name)
    assert_array_equal(LaserScan.decode(found.encode()).ranges, found.ranges)


@given(lists)
def test_the_inputs_stay_as_they_are(rows):
    positive, negative = scan(rows[0]), scan(rows[1])
    before = positive.encode(), negative.encode()
    fuse(Pair(positive, negative), {})
    assert (positive.encode(), negative.encode()) == before


@pytest.mark.parametrize(
    "other", [scan([1.0, 2.0]), scan([1.0] * 3, angle_min=-0.4), scan([1.0] * 3, angle_min=-0.5, increment=0.4)]
)
def test_scans_of_other_beams_are_refused_and_both_are_named(other):
    with pytest.raises(GridMismatch, match=r"positive has .*beams=3.*negative has .*beams="):
        fuse(Pair(scan([1.0] * 3), other), {})


def test_a_scan_of_one_beam_is_fused_like_any_other():
    pair = Pair(scan([INF], angle_min=0.0, increment=0.1), scan([INF], angle_min=0.0, increment=0.1))
    lidar = scan([5.0, 3.0, 6.0], angle_min=-0.2, increment=0.2)
    assert_array_equal(fuse(pair, {"lidar": (LIDAR, lidar)}).ranges, np.float32([3.0]))


def test_the_beams_lie_where_the_increment_says():
    """A driver may give an angle_max one increment beyond its last beam."""
    circle = scan([INF] * 9, angle_min=-0.4, increment=0.1)
    loose = circle.model_copy(update={"angle_max": 0.5})
    lidar = scan([3.0], angle_min=0.4, increment=0.01)
    found = fuse(Pair(loose, loose), {"lidar": (LIDAR, lidar)}).ranges
    assert_array_equal(np.flatnonzero(np.isfinite(found)), [8])
