"""Beams and azimuths."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cliffscan.common.contract.beam_grid import Grid

grids = st.builds(
    lambda beams, middle, width: Grid.between(beams, middle - width / 2, middle + width / 2),
    st.integers(2, 2000),
    st.floats(-1, 1),
    st.floats(0.01, 6),
)


def test_the_default_grid_is_the_contracts():
    grid = Grid.between(640, math.radians(-29), math.radians(29))
    angles = grid.angles()
    assert len(angles) == 640
    assert angles[0] == math.radians(-29)
    assert angles[-1] == pytest.approx(math.radians(29))
    assert grid.increment == pytest.approx(math.radians(58) / 639)


@given(grids)
def test_each_angle_falls_into_its_own_beam(grid):
    np.testing.assert_array_equal(grid.beam_of(grid.angles()), np.arange(grid.beams))


@given(grids, st.floats(-0.499, 0.499))
def test_a_beam_is_half_an_increment_wide_to_either_side(grid, part):
    np.testing.assert_array_equal(grid.beam_of(grid.angles() + part * grid.increment), np.arange(grid.beams))


@given(grids, st.lists(st.floats(-3, 3), min_size=1, max_size=20))
def test_the_beam_of_an_azimuth_is_the_nearest(grid, azimuths):
    for azimuth, beam in zip(azimuths, grid.beam_of(np.array(azimuths)), strict=True):
        if 0 <= beam < grid.beams:
            distances = np.abs(grid.angles() - azimuth)
            assert distances[beam] <= distances.min() + 1e-9
        else:
            beyond = azimuth - grid.angle_max if beam > 0 else grid.angle_min - azimuth
            assert beyond >= grid.increment / 2 - 1e-9


@given(grids)
def test_the_edges_bound_the_beams(grid):
    edges = grid.edges()
    assert edges.shape == (grid.beams + 1,)
    assert_allclose((edges[1:] + edges[:-1]) / 2, grid.angles(), atol=1e-12)
    assert_allclose(np.diff(edges), grid.increment, atol=1e-12)


def test_grids_match_that_differ_by_rounding_only():
    grid = Grid.between(640, -0.5, 0.5)
    assert grid.matches(Grid(640, -0.5 + 1e-9, grid.increment * (1 + 1e-9)))
    for other in (Grid(639, -0.5, grid.increment), Grid(640, -0.499, grid.increment), Grid(640, -0.5, 0.00157)):
        assert not grid.matches(other)
        assert not other.matches(grid)
