"""A camera turned upright sees what it saw, in an image that leans by no more than 45°."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import Region, scan_axes
from cliffscan.simulator.kinect import kinect_camera
from evaluation.scenes.mounts import floor_in_view, upright
from evaluation.truth.sight import floor_in_sight, measurable, row_spacing

ROLLS = (-179.0, -135.5, -90.0, -60.0, 0.0, 3.0, 44.0, 46.0, 90.0, 120.0, 180.0)
ANGLES = np.radians(np.linspace(-20.0, 20.0, 9))


def camera(roll, pitch=20.0, height=0.4):
    """A Kinect whose image has a border that returns nothing, another on each side."""
    seen = Region(3, 5, 600, 470)
    return replace(kinect_camera(height, math.radians(pitch), math.radians(roll)), seen=seen)


@pytest.mark.parametrize("roll", ROLLS)
def test_turned_upright_it_leans_little_and_sees_the_same_floor(roll):
    given, turned = camera(roll), upright(camera(roll))
    assert abs(math.degrees(turned.floor.mount()[2])) <= 45.0 + 1e-9
    for one, other in zip(scan_axes(given), scan_axes(turned), strict=True):
        np.testing.assert_allclose(np.sort(one.table(), axis=None), np.sort(other.table(), axis=None), atol=1e-9)
    for distance in (0.5, 0.6, 0.7, 0.9, 2.0):
        at = np.full(len(ANGLES), distance)
        assert np.array_equal(measurable(given, ANGLES, at), measurable(turned, ANGLES, at))


def test_a_camera_that_leans_little_is_left_as_it_is():
    assert upright(camera(44.0)) == camera(44.0)


@pytest.mark.parametrize("roll", [90.0, 180.0, -90.0])
def test_rows_of_a_camera_on_its_side_lie_as_those_of_one_that_stands(roll):
    at, standing = np.full(len(ANGLES), 1.5), kinect_camera(0.4, math.radians(20.0))
    turned = kinect_camera(0.4, math.radians(20.0), math.radians(roll))
    focal = turned.intrinsics.fx / turned.intrinsics.fy if abs(roll) == 90.0 else 1.0
    assert row_spacing(turned, ANGLES, at) * focal == pytest.approx(row_spacing(standing, ANGLES, at), rel=1e-6)
    assert floor_in_view(kinect_camera(0.3, 0.0, math.radians(180.0))) == pytest.approx(floor_in_view(kinect_camera()))


def test_floor_is_in_sight_where_enough_of_it_is_in_the_image_and_in_range():
    assert floor_in_sight(kinect_camera(), ANGLES).all()
    assert not floor_in_sight(kinect_camera(0.3, math.radians(-25.0)), ANGLES).any()
    assert not floor_in_sight(kinect_camera(0.2, math.radians(60.0)), ANGLES).any()  # nearer than it measures
    aside = floor_in_sight(kinect_camera(), np.radians([-35.0, -28.0, 28.0, 35.0]))
    assert aside.tolist() == [False, True, True, False]
