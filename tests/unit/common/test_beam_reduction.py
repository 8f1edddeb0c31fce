"""Which pixels each beam sees."""

import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.perception.beam_reduction import BLOCK, LOOKED, NOTHING, min_per_beam
from cliffscan.common.perception.image_region import image_region
from tests import naive
from tests.build import camera

GRID = Grid.between(33, -0.4, 0.4)


def beams_of(view, grid, row, column):
    """The beams that see a pixel of a view: those that have a range where it alone says anything."""
    values = np.full(view.shape, NOTHING)
    values[row, column] = 1.0
    return set(np.flatnonzero(~np.isnan(min_per_beam(values, view, grid))))


def seen_by_naive(lens, grid, view):
    """The beams that see each pixel of a view; not those pixels that look backward, for they hold no point."""
    expected = {}
    for row, column, beam in naive.pixels_of_beams(lens, grid):
        expected.setdefault((row, column), set()).add(beam)
    for row, column in np.ndindex(view.shape):
        v, u = (column, row) if view.transposed else (row, column)
        v += view.rows.start
        if naive.axes(lens)[0].dot(naive.ray(lens, v, u)) > 0:
            yield row, column, expected.get((v, u), set())


def assert_sees_what_naive_sees(lens, grid, lower_than=math.inf):
    view = image_region(lens, lower_than)
    for row, column, expected in seen_by_naive(lens, grid, view):
        assert beams_of(view, grid, row, column) == expected, f"pixel {row}, {column}"


@pytest.mark.parametrize("pitch", [0.0, 0.3, 0.9, -0.3])
@pytest.mark.parametrize("roll", [0.0, 0.2, -0.7, math.pi])
def test_a_beam_sees_the_pixels_within_half_an_increment(pitch, roll):
    assert_sees_what_naive_sees(camera(32, 24, 29.0, (0.5, pitch, roll), centre=(15.37, 11.61)), GRID)


@settings(max_examples=20)
@given(st.floats(-math.pi, math.pi), st.floats(-0.3, 0.3), st.floats(-0.5, 1.0))
def test_a_wide_beam_sees_the_same_pixels_however_the_camera_is_rolled(roll, pitch, lower_than):
    lens = camera(12, 10, 10.0, (0.5, pitch, roll), centre=(5.37, 4.61))
    assert_sees_what_naive_sees(lens, Grid.between(4, -0.61, 0.6), lower_than)


@pytest.mark.parametrize(("beams", "view"), [(2, 58), (3, 58), (9, 150), (400, 170)])
def test_a_beam_may_be_wide_or_narrow(beams, view):
    half = math.radians(view) / 2
    assert_sees_what_naive_sees(camera(32, 24, 12.0, centre=(15.37, 11.61)), Grid.between(beams, -half, half))


@pytest.mark.parametrize(("beams", "view"), [(2, 100), (3, 150), (9, 170)])
def test_a_beam_that_reaches_behind_the_camera_sees_only_what_is_ahead(beams, view):
    half = math.radians(view) / 2
    assert_sees_what_naive_sees(camera(32, 24, 12.0, centre=(15.37, 11.61)), Grid.between(beams, -half, half))


@settings(max_examples=10)
@given(st.floats(-0.5, 0.9), st.floats(-1.0, 1.0), st.integers(5, 60), st.floats(0.2, 0.8))
def test_any_camera_and_any_grid(pitch, roll, beams, half):
    lens = camera(16, 12, 12.0, (0.5, pitch, roll * math.radians(40)), centre=(7.37, 5.61))
    assert_sees_what_naive_sees(lens, Grid.between(beams, -half + 1e-4, half + 1e-4))


@settings(max_examples=30)
@given(st.integers(100, 1000), st.floats(-0.5, 0.5))
def test_a_beam_narrower_than_a_column_takes_the_one_that_covers_it(beams, offset):
    lens = camera(16, 4, 16.0, centre=(7.5 + offset, 1.5))
    half = math.atan(6 / 16.0)  # all of it within the image
    grid = Grid.between(beams, -half, half)
    view = image_region(lens, math.inf)
    by_column = [beams_of(view, grid, 0, column) for column in range(16)]
    seen = np.array([[beam in seen for seen in by_column] for beam in range(beams)])
    assert (seen.sum(axis=1) == 1).all()
    middle = 7.5 + offset - 16.0 * np.tan(grid.angles())
    assert (np.abs(seen.argmax(axis=1) - middle) <= 1).all()


@settings(max_examples=10, phases=(Phase.generate,))  # a smaller example would take minutes to find
@given(st.floats(-0.5, 1.0), st.floats(-0.6, 0.6), st.integers(3, 60), st.integers(0, 2**32 - 1))
def test_a_beam_has_the_least_of_all_that_it_sees_in_all_blocks_of_rows(pitch, roll, beams, seed):
    lens = camera(12, 2 * BLOCK + 7, 24.0, (0.5, pitch, roll), centre=(5.37, 33.61))
    grid, noise = Grid.between(beams, -0.31, 0.3), np.random.default_rng(seed)
    view = image_region(lens, math.inf)
    values = noise.choice([1.0, 2.0, 3.0, 4.0, LOOKED, NOTHING], view.shape, p=[0.01, 0.02, 0.03, 0.04, 0.2, 0.7])
    expected = np.full(beams, np.nan)
    for row, column, seen in seen_by_naive(lens, grid, view):
        if values[row, column] != NOTHING:
            value = math.inf if values[row, column] == LOOKED else values[row, column]
            expected[list(seen)] = np.fmin(expected[list(seen)], value)
    ahead = view.forward.table() > 0
    said = np.where(ahead, values, NOTHING).astype(np.float32)
    np.testing.assert_array_equal(min_per_beam(said, view, grid), expected.astype(np.float32))


def test_the_least_number_wins_over_having_looked_and_that_over_nothing():
    view, grid = image_region(camera(), math.inf), Grid.between(5, -0.4, 0.4)
    for values, expected in (((2.0, 1.5), 1.5), ((LOOKED, 3.0), 3.0), ((NOTHING, LOOKED), math.inf)):
        said = np.full(view.shape, NOTHING)
        said[7, 31:33] = values  # both within the middle beam
        assert min_per_beam(said, view, grid)[2] == np.float32(expected)
        assert np.isnan(min_per_beam(said, view, grid)[[0, 4]]).all()
