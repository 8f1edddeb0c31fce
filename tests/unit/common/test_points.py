"""A depth image as points over the floor, and the columns that each beam sees."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from common.grid import Grid
from common.points import points_of
from tests import naive
from tests.build import camera

GRID = Grid.between(33, -0.4, 0.4)
FLAT = np.full((48, 64), 2000, np.uint16)


def seen_by(seen):
    """The (row, column) of every beam."""
    rows, beams = seen.first.shape
    return [
        {(row, column) for row in range(rows) for column in range(seen.first[row, beam], seen.end[row, beam])}
        for beam in range(beams)
    ]


def assert_sees_what_naive_sees(view, grid):
    seen = points_of(np.full((view.height, view.width), 1000, np.uint16), view, grid)
    transposed = seen.heights.shape != (view.height, view.width)
    expected = [set() for _ in range(grid.beams)]
    for row, column, beam in naive.pixels_of_beams(view, grid):
        expected[beam].add((column, row) if transposed else (row, column))
    for beam, (found, naively) in enumerate(zip(seen_by(seen), expected, strict=True)):
        odd = {pixel for pixel in found ^ naively if seen.distances[pixel] > 0}  # what looks backward holds no point
        assert not odd, f"beam {beam}"


def test_points_of_a_level_camera():
    seen = points_of(FLAT, camera(), GRID)
    assert seen.heights[24, 32] == pytest.approx(0.3)
    assert seen.heights[24 + 5, 32] == pytest.approx(0.3 - 2 * 5 / 58)
    assert seen.distances[0, 32] == pytest.approx(2.0)  # the floor's distance does not grow with the height
    assert seen.distances[24, 32 + 29] == pytest.approx(math.hypot(2.0, 1.0))


def test_points_of_a_camera_that_looks_down():
    seen = points_of(FLAT, camera(mount=(1.0, math.radians(30), 0)), GRID)
    assert seen.heights[24, 32] == pytest.approx(0.0)
    assert seen.distances[24, 32] == pytest.approx(2 * math.cos(math.radians(30)))


@pytest.mark.parametrize(
    ("depth", "usable"),
    [(0, False), (1, False), (499, False), (500, True), (4500, True), (4501, False), (65535, False)],
)
def test_a_depth_outside_the_sensors_range_is_no_measurement(depth, usable):
    seen = points_of(np.full((48, 64), depth, np.uint16), camera(), GRID)
    assert np.isfinite(seen.heights).all() == usable
    assert np.isnan(seen.heights).all() != usable


def test_no_return_is_no_measurement_even_where_the_sensor_begins_at_nothing():
    seen = points_of(np.zeros((48, 64), np.uint16), camera(reach=(0.0, 4.5)), GRID)
    assert np.isnan(seen.heights).all()


def test_what_is_nearer_than_range_min_is_part_of_the_robot():
    view = camera(mount=(1.0, math.radians(60), 0))
    seen = points_of(FLAT, view, GRID, range_min=1.2)
    near = seen.distances < 1.2
    assert near.any()
    assert (~near).any()
    np.testing.assert_array_equal(np.isnan(seen.heights), near)


def test_a_ray_that_leads_backward_holds_no_point():
    view = camera(mount=(1.0, math.radians(80), 0))
    seen = points_of(FLAT, view, GRID)
    assert np.isnan(seen.heights[-1]).all()  # the image's lowest rows look behind the robot's feet
    assert np.isfinite(seen.heights[24]).all()


@pytest.mark.parametrize("roll", [90, -90])
def test_a_camera_on_its_side_is_looked_at_transposed(roll):
    view = camera(mount=(0.3, 0, math.radians(roll)))
    depth = FLAT.copy()
    depth[30, 40] = 3000
    seen = points_of(depth, view, GRID)
    assert seen.heights.shape == (64, 48)
    right = 1 if roll > 0 else -1  # leaning right, the image's right is low and its lower half lies on the left
    assert seen.heights[40, 30] == pytest.approx(0.3 - right * 3 * 8 / 58)
    beam = int(GRID.beam_of(np.array(math.atan2(right * 6, 58))))
    assert (40, 30) in seen_by(seen)[beam]


@pytest.mark.parametrize("pitch", [0.0, 0.3, 0.9, -0.3])
@pytest.mark.parametrize("roll", [0.0, 0.2, -0.7, math.pi])
def test_a_beam_sees_the_pixels_within_half_an_increment(pitch, roll):
    assert_sees_what_naive_sees(camera(32, 24, 29.0, (0.5, pitch, roll), centre=(15.37, 11.61)), GRID)


@settings(max_examples=20, deadline=None)
@given(st.floats(-math.pi, math.pi), st.floats(-0.3, 0.3))
def test_a_wide_beam_sees_the_same_pixels_however_the_camera_is_rolled(roll, pitch):
    view = camera(12, 10, 10.0, (0.5, pitch, roll), centre=(5.37, 4.61))
    assert_sees_what_naive_sees(view, Grid.between(4, -0.61, 0.6))


@pytest.mark.parametrize(("beams", "view"), [(2, 58), (3, 58), (9, 150), (400, 170)])
def test_a_beam_may_be_wide_or_narrow(beams, view):
    half = math.radians(view) / 2
    assert_sees_what_naive_sees(camera(32, 24, 12.0, centre=(15.37, 11.61)), Grid.between(beams, -half, half))


@pytest.mark.parametrize(("beams", "view"), [(2, 100), (3, 150), (9, 170)])
def test_a_beam_that_reaches_behind_the_camera_sees_only_what_is_ahead(beams, view):
    half = math.radians(view) / 2
    assert_sees_what_naive_sees(camera(32, 24, 12.0, centre=(15.37, 11.61)), Grid.between(beams, -half, half))


@settings(max_examples=30)
@given(st.integers(100, 1000), st.floats(-0.5, 0.5))
def test_a_beam_narrower_than_a_column_takes_the_one_that_covers_it(beams, offset):
    view = camera(16, 4, 16.0, centre=(7.5 + offset, 1.5))
    half = math.atan(6 / 16.0)  # all of it within the image
    seen = points_of(np.full((4, 16), 1000, np.uint16), view, Grid.between(beams, -half, half))
    counts = seen.end - seen.first
    assert counts.min() == 1
    middle = 7.5 + offset - 16.0 * np.tan(Grid.between(beams, -half, half).angles())
    assert (np.abs(seen.first[0] - middle)[counts[0] == 1] <= 1).all()


@settings(max_examples=30)
@given(st.floats(0.1, 2), st.floats(-0.5, 1.2), st.floats(-math.pi, math.pi), st.integers(0, 2**32 - 1))
def test_points_obey_the_floor_plane(height, pitch, roll, seed):
    view = camera(16, 12, 14.0, (height, pitch, roll), reach=(0.1, 60))
    depth = np.random.default_rng(seed).integers(200, 9000, (12, 16)).astype(np.uint16)
    seen = points_of(depth, view, GRID)
    v, u = np.mgrid[:12, :16]
    points = np.stack([(u - 8) / 14, (v - 6) / 14, np.ones(u.shape)], axis=-1) * depth[..., None] / 1000
    heights = points @ np.array(view.floor[:3]) + height
    if seen.heights.shape != depth.shape:
        heights, points = heights.T, points.transpose(1, 0, 2)
    ahead = ~np.isnan(seen.heights)
    assert_allclose(seen.heights[ahead], heights[ahead], rtol=1e-6, atol=1e-6)
    across = np.linalg.norm(points, axis=-1) ** 2 - (heights - height) ** 2
    assert_allclose(seen.distances[ahead] ** 2, across[ahead], rtol=1e-6, atol=1e-6)


def test_another_frame_of_the_same_camera_is_looked_at_anew():
    view = camera()
    first = points_of(FLAT, view, GRID)
    again = points_of(FLAT // 2, view, GRID)
    assert_allclose(again.distances * 2, first.distances)
    assert np.isfinite(first.heights).all()  # and the first is left alone
