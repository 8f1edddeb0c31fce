"""A depth image as points over the floor."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cliffscan.common.perception.floor_points import floor_points
from tests.build import camera

FLAT = np.full((48, 64), 2000, np.uint16)


def test_points_of_a_level_camera():
    seen = floor_points(FLAT, camera())
    assert seen.heights[24, 32] == pytest.approx(0.3)
    assert seen.heights[24 + 5, 32] == pytest.approx(0.3 - 2 * 5 / 58)
    assert seen.distances[0, 32] == pytest.approx(2.0)  # the floor's distance does not grow with the height
    assert seen.distances[24, 32 + 29] == pytest.approx(math.hypot(2.0, 1.0))


def test_points_of_a_camera_that_looks_down():
    seen = floor_points(FLAT, camera(mount=(1.0, math.radians(30), 0)))
    assert seen.heights[24, 32] == pytest.approx(0.0)
    assert seen.distances[24, 32] == pytest.approx(2 * math.cos(math.radians(30)))


@pytest.mark.parametrize(
    ("depth", "usable"),
    [(0, False), (1, False), (499, False), (500, True), (4500, True), (4501, False), (65535, False)],
)
def test_a_depth_outside_the_sensors_range_is_no_measurement(depth, usable):
    seen = floor_points(np.full((48, 64), depth, np.uint16), camera())
    assert np.isfinite(seen.heights).all() == usable
    assert np.isnan(seen.heights).all() != usable


def test_no_return_is_no_measurement_even_where_the_sensor_begins_at_nothing():
    seen = floor_points(np.zeros((48, 64), np.uint16), camera(reach=(0.0, 4.5)))
    assert np.isnan(seen.heights).all()


def test_what_is_nearer_than_range_min_is_part_of_the_robot():
    view = camera(mount=(1.0, math.radians(60), 0))
    seen = floor_points(FLAT, view, range_min=1.2)
    near = seen.distances < 1.2
    assert near.any()
    assert (~near).any()
    np.testing.assert_array_equal(np.isnan(seen.heights), near)


def test_a_ray_that_leads_backward_holds_no_point():
    view = camera(mount=(1.0, math.radians(80), 0))
    seen = floor_points(FLAT, view)
    assert np.isnan(seen.heights[-1]).all()  # the image's lowest rows look behind the robot's feet
    assert np.isfinite(seen.heights[24]).all()


@pytest.mark.parametrize("roll", [90, -90])
def test_a_camera_on_its_side_is_looked_at_transposed(roll):
    view = camera(mount=(0.3, 0, math.radians(roll)))
    depth = FLAT.copy()
    depth[30, 40] = 3000
    seen = floor_points(depth, view)
    assert seen.heights.shape == (64, 48)
    right = 1 if roll > 0 else -1  # leaning right, the image's right is low and its lower half lies on the left
    assert seen.heights[40, 30] == pytest.approx(0.3 - right * 3 * 8 / 58)


@settings(max_examples=30)
@given(st.floats(0.1, 2), st.floats(-0.5, 1.2), st.floats(-math.pi, math.pi), st.integers(0, 2**32 - 1))
def test_points_obey_the_floor_plane(height, pitch, roll, seed):
    view = camera(16, 12, 14.0, (height, pitch, roll), reach=(0.1, 60))
    depth = np.random.default_rng(seed).integers(200, 9000, (12, 16)).astype(np.uint16)
    seen = floor_points(depth, view)
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
    first = floor_points(FLAT, view)
    again = floor_points(FLAT // 2, view)
    assert_allclose(again.distances * 2, first.distances)
    assert np.isfinite(first.heights).all()  # and the first is left alone


@settings(max_examples=30)
@given(st.floats(0.1, 2), st.floats(-0.5, 1.2), st.floats(-math.pi, math.pi), st.floats(-0.5, 1), st.integers(0, 2**32))
def test_what_is_left_out_is_higher_than_asked_for(height, pitch, roll, lower_than, seed):
    view = camera(16, 12, 14.0, (height, pitch, roll), reach=(0.1, 60))
    depth = np.random.default_rng(seed).integers(0, 9000, (12, 16)).astype(np.uint16)
    every, some = floor_points(depth, view), floor_points(depth, view, lower_than=lower_than)
    kept = np.zeros(depth.shape, bool)
    kept[some.region.rows] = True
    kept = kept.T if some.region.transposed else kept
    assert_allclose(some.heights.ravel(), every.heights[kept], rtol=1e-6, atol=1e-6)
    assert not (every.heights[~kept] <= lower_than).any()
