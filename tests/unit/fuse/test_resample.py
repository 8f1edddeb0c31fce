"""Readings from elsewhere on the robot land in the beams that would have seen them, and never farther away."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.services.fuse.resample import resample

GRID = Grid.between(59, -math.radians(29), math.radians(29))
CENTRE = (0.0, 0.0, 0.0)
beam_counts = st.integers(3, 80)
poses = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-math.pi, math.pi))


def sweep(beams, half=math.pi):
    """Angles from -half to just below half, and their increment."""
    increment = 2 * half / beams
    return -half + increment * np.arange(beams), increment


def wall_ahead(distance, pose, angles):
    """Ranges [m] at which a scanner at `pose` sees the plane x = distance; inf where it looks away from it."""
    x, _, yaw = pose
    cos = np.cos(yaw + angles)
    with np.errstate(divide="ignore"):
        return np.where(cos > 1e-6, (distance - x) / cos, np.inf).astype(np.float32)


def seen(ranges, angles, increment, pose=CENTRE, grid=GRID):
    return resample(np.asarray(ranges, np.float32), np.asarray(angles, float), increment, pose, grid)


def test_a_scan_of_the_same_beams_from_the_same_place_stays_as_it_is():
    ranges = np.linspace(1, 5, GRID.beams).astype(np.float32)
    assert_allclose(seen(ranges, GRID.angles(), GRID.increment * 0.999), ranges, rtol=1e-6)


@pytest.mark.parametrize(
    "pose", [CENTRE, (0.2, 0.0, 0.0), (-0.1, 0.15, 0.0), (0.1, -0.2, 1.0), (0.0, 0.3, math.pi), (-0.3, -0.3, -2.0)]
)
def test_a_wall_ahead_is_a_wall_ahead_wherever_the_scanner_stands(pose):
    angles, increment = sweep(3600)
    found = seen(wall_ahead(3.0, pose, angles), angles, increment, pose)
    assert_allclose(found, 3.0 / np.cos(GRID.angles()), atol=0.04)  # half a beam at 29 degrees, and one reading
    assert (found <= 3.0 / np.cos(GRID.angles()) + 0.003).all()


@pytest.mark.parametrize("beams", [90, 180, 360])
@pytest.mark.parametrize("pose", [CENTRE, (0.2, 0.1, 0.5), (-0.2, -0.3, 2.5)])
def test_a_scanner_coarser_than_the_grid_leaves_no_gaps(beams, pose):
    angles, increment = sweep(beams)
    assert np.isfinite(seen(wall_ahead(2.0, pose, angles), angles, increment, pose)).all()


def test_a_reading_fills_its_increment_and_no_more():
    fine = Grid.between(1001, -0.5, 0.5)
    found = seen([2.0], [0.1], 0.2, grid=fine)
    (filled,) = np.nonzero(np.isfinite(found))
    azimuths = fine.angles()[filled]
    assert azimuths.min() == pytest.approx(0.0, abs=fine.increment)
    assert azimuths.max() == pytest.approx(0.2, abs=fine.increment)
    assert (np.diff(filled) == 1).all()
    assert_allclose(found[filled], 2.0)


def test_a_turned_scanner_sees_to_its_side():
    found = seen([2.0], [0.0], 0.001, (0.0, 0.0, math.radians(20)))
    assert np.flatnonzero(np.isfinite(found)).tolist() == [29 + 20]
    assert found[49] == pytest.approx(2.0)


@pytest.mark.parametrize("angle", [1.0, math.pi / 2, math.pi, -math.pi, -2.0])
def test_a_reading_beside_or_behind_is_nothing_ahead(angle):
    assert np.isposinf(seen([2.0], [angle], 0.02)).all()


def test_a_scanner_that_stands_far_ahead_sees_what_is_behind_it():
    found = seen([0.5], [math.pi], 0.02, (2.0, 0.0, 0.0))
    assert found[29] == pytest.approx(1.5, abs=1e-3)


@pytest.mark.parametrize("turns", [-4 * math.pi, -2 * math.pi, 2 * math.pi])
def test_angles_may_be_counted_any_number_of_times_round(turns):
    angles, increment = sweep(720)
    ranges = wall_ahead(3.0, CENTRE, angles)
    assert_allclose(seen(ranges, angles + turns, increment), seen(ranges, angles, increment), rtol=1e-5)


def test_a_full_circle_may_begin_ahead():
    angles, increment = sweep(720)
    ranges = wall_ahead(3.0, CENTRE, angles)
    from_zero = np.roll(ranges, 360)
    assert_allclose(seen(from_zero, angles + math.pi, increment), seen(ranges, angles, increment), rtol=1e-5)


@pytest.mark.parametrize("nothing", [math.nan, math.inf])
def test_what_is_no_number_is_no_obstacle(nothing):
    angles, increment = sweep(360)
    assert np.isposinf(seen(np.full(360, nothing), angles, increment)).all()
    assert np.isposinf(seen([], [], 0.1)).all()


def test_of_several_readings_in_a_beam_the_nearest_counts():
    angles = np.array([-0.001, 0.0, 0.001])
    assert seen([3.0, 2.0, 4.0], angles, 0.001)[29] == pytest.approx(2.0)


def test_the_result_is_single_precision_on_the_grid():
    found = seen([2.0], [0.0], 0.1)
    assert found.dtype == np.float32
    assert found.shape == (GRID.beams,)


@given(poses, st.lists(st.floats(0.0625, 10, width=32), min_size=1, max_size=60), st.integers(30, 400), beam_counts)
def test_no_reading_is_farther_away_than_it_was_measured(pose, ranges, around, beams):
    """In every beam that looks at a reading's middle, the scan is at most as far as that reading."""
    angles, increment = np.arange(len(ranges)) * 2 * math.pi / around, 2 * math.pi / around
    grid = Grid.between(beams, -0.7, 0.7)
    found = seen(ranges, angles, increment, pose, grid)
    x, y, yaw = pose
    for distance, heading in zip(np.float64(ranges), yaw + angles, strict=True):
        ahead, left = x + distance * math.cos(heading), y + distance * math.sin(heading)
        beam = int(grid.beam_of(np.array(math.atan2(left, ahead))))
        if 0 <= beam < beams and math.hypot(ahead, left) > 0.1:  # what is nearer is the camera itself
            assert found[beam] <= math.hypot(ahead, left) * (1 + 1e-5)


@given(poses, st.lists(st.floats(0.5, 10, width=32), min_size=1, max_size=40))
def test_no_obstacle_is_made_up(pose, ranges):
    """Every number is the distance of a reading, as far as its arc lets it vary."""
    angles, increment = np.arange(len(ranges)) * 0.05 - 1, 0.05
    x, y, yaw = pose
    headings = yaw + angles
    far = np.hypot(x + ranges * np.cos(headings), y + ranges * np.sin(headings))
    slack = np.array(ranges) * increment / 2
    for number in (found := seen(ranges, angles, increment, pose))[np.isfinite(found)]:
        assert ((number <= far * (1 + 1e-5)) & (number >= far - slack - 1e-5)).any()
