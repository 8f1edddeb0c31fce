"""The camera over the floor: heights, distances and azimuths as one works them out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cliffscan.common.contract.camera import FloorPlane, Intrinsics, axes, check_camera, reach, scan_axes
from tests.build import camera

heights = st.floats(0.05, 20)
pitches = st.floats(-1.5, 1.5)
rolls = st.floats(-math.pi, math.pi)


def point(view, row, column, depth):
    """(ahead, left, height) [m] of a pixel `depth` [m] away."""
    ahead, left, up = (axis.table()[row, column] * depth for axis in scan_axes(view))
    return ahead, left, up + view.floor.d


@given(heights, pitches, rolls)
def test_a_mounts_normal_is_a_unit_vector_and_its_height_the_planes(height, pitch, roll):
    floor = FloorPlane.from_mount(height, pitch, roll)
    assert math.hypot(*floor[:3]) == pytest.approx(1)
    assert floor.d == height


def test_a_level_camera_has_the_contracts_plane():
    assert_allclose(FloorPlane.from_mount(0.3), (0, -1, 0, 0.3), atol=1e-15)


@pytest.mark.parametrize(
    ("pitch", "roll", "normal"),
    [
        (30, 0, (0, -math.cos(math.pi / 6), -0.5)),  # looking down, the floor's normal comes towards the camera
        (-30, 0, (0, -math.cos(math.pi / 6), 0.5)),
        (0, 90, (-1, 0, 0)),  # leaning to its right until it lies on that side, up is the image's left
        (0, -90, (1, 0, 0)),
        (0, 180, (0, 1, 0)),
    ],
)
def test_a_tilted_cameras_normal(pitch, roll, normal):
    floor = FloorPlane.from_mount(1.0, math.radians(pitch), math.radians(roll))
    assert_allclose(floor[:3], normal, atol=1e-15)


@given(heights, pitches, rolls, st.floats(0.995, 1.005))
def test_the_axes_are_orthonormal_and_right_handed(height, pitch, roll, length):
    nx, ny, nz, d = FloorPlane.from_mount(height, pitch, roll)
    forward, left, up = axes(FloorPlane(nx * length, ny * length, nz * length, d))
    base = np.array([forward, left, up])
    assert_allclose(base @ base.T, np.eye(3), atol=1e-9)
    assert_allclose(np.cross(forward, left), up, atol=1e-9)
    assert forward[2] > 0  # the camera looks forward


def test_a_level_camera_sees_along_its_own_axes():
    forward, left, up = axes(FloorPlane.from_mount(0.3))
    assert_allclose([forward, left, up], [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], atol=1e-15)


def test_points_of_a_level_camera():
    view = camera(focal=58.0, mount=(0.3, 0, 0))
    assert point(view, 24, 32, 2.0) == pytest.approx((2.0, 0.0, 0.3))
    assert point(view, 24 + 10, 32, 2.0) == pytest.approx((2.0, 0.0, 0.3 - 2.0 * 10 / 58))
    assert point(view, 24, 32 + 29, 2.0) == pytest.approx((2.0, -1.0, 0.3))  # right of the centre is negative
    assert point(view, 24, 32 - 29, 2.0) == pytest.approx((2.0, 1.0, 0.3))


def test_columns_go_by_fx_and_rows_by_fy():
    view = replace(camera(), intrinsics=Intrinsics(50.0, 100.0, 30.0, 20.0))
    assert point(view, 20 + 10, 30 + 10, 2.0) == pytest.approx((2.0, -2 * 10 / 50, 0.3 - 2 * 10 / 100))


def test_a_camera_that_looks_down_meets_the_floor_where_its_axis_does():
    ahead, left, height = point(camera(mount=(0.5, math.radians(30), 0)), 24, 32, 1.0)
    assert (ahead, left, height) == pytest.approx((math.cos(math.radians(30)), 0, 0))


def test_a_camera_that_leans_right_sees_the_floor_on_its_images_right():
    view = camera(mount=(0.3, 0, math.radians(20)))
    low, high = point(view, 24, 40, 2.0), point(view, 24, 24, 2.0)
    assert low[2] < 0.3 < high[2]
    assert low[1] < 0 < high[1]  # and that is still on the robot's right
    beside, lean = 2 * 8 / 58, math.radians(20)
    assert low == pytest.approx((2.0, -beside * math.cos(lean), 0.3 - beside * math.sin(lean)))


@given(heights, pitches, rolls, st.integers(0, 47), st.integers(0, 63), st.floats(0.1, 9))
def test_a_point_lies_as_high_as_the_plane_says(height, pitch, roll, row, column, depth):
    view = camera(mount=(height, pitch, roll))
    ray = np.array([(column - 32) / 58, (row - 24) / 58, 1.0])
    expected = np.dot(view.floor[:3], ray * depth) + view.floor.d
    found = point(view, row, column, depth)
    assert found[2] == pytest.approx(expected, abs=1e-9)
    assert math.hypot(*found[:2], found[2] - height) == pytest.approx(depth * np.linalg.norm(ray))


@given(pitches, rolls, st.integers(0, 47), st.integers(0, 63))
def test_a_pixels_azimuth_does_not_depend_on_its_depth(pitch, roll, row, column):
    view = camera(mount=(0.3, pitch, roll))
    (ahead, left, _), (ahead_far, left_far, _) = (point(view, row, column, depth) for depth in (0.5, 4.0))
    assume(math.hypot(ahead, left) > 1e-3)
    assert math.atan2(left, ahead) == pytest.approx(math.atan2(left_far, ahead_far))


def test_a_level_camera_reaches_to_its_images_corner():
    view = camera(width=65, centre=(32, 24), focal=32.0, reach=(0.5, 4.0))
    assert reach(view) == pytest.approx(4.0 * math.sqrt(2))


@given(heights, pitches, rolls, st.integers(0, 47), st.integers(0, 63))
def test_no_pixel_reaches_farther_than_the_camera(height, pitch, roll, row, column):
    view = camera(mount=(height, pitch, roll))
    ahead, left, _ = point(view, row, column, view.range[1])
    assert math.hypot(ahead, left) <= reach(view) * (1 + 1e-12)


@given(heights, st.floats(-1.51, 1.51), rolls)
def test_any_mount_makes_a_possible_camera(height, pitch, roll):
    check_camera(camera(mount=(height, pitch, roll)))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("intrinsics", Intrinsics(6.3, 58, 32, 24)),
        ("intrinsics", Intrinsics(58, 4801, 32, 24)),
        ("intrinsics", Intrinsics(58, 58, -65, 24)),
        ("intrinsics", Intrinsics(58, 58, 32, 97)),
        ("intrinsics", Intrinsics(math.nan, 58, 32, 24)),
        ("range", (-0.1, 4.5)),
        ("range", (4.5, 4.5)),
        ("range", (0.5, math.inf)),
        ("range", (0, 4500)),
        ("range", (math.nan, 4.5)),
        ("floor", FloorPlane(0, -1.02, 0, 0.3)),
        ("floor", FloorPlane(0, -0.98, 0, 0.3)),
        ("floor", FloorPlane(0, 0, 1, 0.3)),
        ("floor", FloorPlane.from_mount(0.3, math.radians(88))),
        ("floor", FloorPlane(0, -1, 0, 0)),
        ("floor", FloorPlane(0, -1, 0, 20.1)),
    ],
)
def test_an_impossible_camera_names_its_field(field, value):
    with pytest.raises(ValueError, match=field):
        check_camera(replace(camera(), **{field: value}))
