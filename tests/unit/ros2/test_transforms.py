"""Frames stand where the description says."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, axes
from cliffscan.common.contract.description import CameraDescription, Place
from cliffscan.services.ros2.transforms import heading, heading_of, of_camera, of_odometry, quaternion
from tests.build import camera
from tests.unit.ros2.test_messages import ODOMETRY


def rotated(rotation, vector):
    """A vector (3,) turned by a quaternion."""
    x, y, z, w = rotation
    axis = np.array([x, y, z])
    return vector + 2 * np.cross(axis, np.cross(axis, vector) + w * np.asarray(vector))


@pytest.mark.parametrize("pitch", [0.0, 0.3, -0.2, 1.2])
@pytest.mark.parametrize("roll", [0.0, 0.4, -math.pi / 2, math.pi])
def test_a_rotation_matrix_becomes_its_quaternion(pitch, roll):
    matrix = np.stack(axes(FloorPlane.from_mount(0.3, pitch, roll)))
    rotation = quaternion(matrix)
    assert math.hypot(*rotation) == pytest.approx(1.0)
    for column, axis in zip(matrix.T, np.eye(3), strict=True):
        np.testing.assert_allclose(rotated(rotation, axis), column, atol=1e-12)


@pytest.mark.parametrize("theta", [0.0, 1.0, -3.0, math.pi, 7.0])
def test_a_heading_comes_back(theta):
    assert math.cos(heading_of(heading(theta)) - theta) == pytest.approx(1.0)


def test_the_scans_frame_stands_over_the_point_below_the_camera():
    made = CameraDescription.of(camera(mount=(0.4, 0.2, 0.0)), "eye", False, Place(-0.1, 0.05, 0.5))
    footprint, scan, eye, optical = of_camera(made, "base_footprint", 0.12, stamp=5)
    assert [(each.parent, each.child) for each in (footprint, scan, eye, optical)] == [
        ("base_footprint", "camera_footprint"),
        ("camera_footprint", "camera_scan"),
        ("camera_footprint", "camera_link"),
        ("camera_link", "eye"),
    ]
    assert (footprint.translation, heading_of(footprint.rotation)) == ((-0.1, 0.05, 0.0), pytest.approx(0.5))
    assert scan.translation == (0.0, 0.0, 0.12)
    assert (eye.translation, optical.translation) == ((0.0, 0.0, pytest.approx(0.4)), (0.0, 0.0, 0.0))


@pytest.mark.parametrize("mount", [(0.4, 0.2, 0.0), (0.3, -0.1, 0.3), (0.5, 0.9, -1.5)])
def test_the_optical_frame_looks_as_rep_103_has_it_from_where_the_camera_stands(mount):
    made = CameraDescription.of(camera(mount=mount), "eye", False)
    *_, eye, optical = of_camera(made, "base_link", 0.12, stamp=5)
    for ours, theirs in (([0, 0, 1], [1, 0, 0]), ([1, 0, 0], [0, -1, 0]), ([0, 1, 0], [0, 0, -1])):
        np.testing.assert_allclose(rotated(optical.rotation, ours), theirs, atol=1e-12)
    to_floor = np.stack(axes(FloorPlane.from_mount(*mount)))
    for axis in np.eye(3):
        turned = rotated(eye.rotation, rotated(optical.rotation, axis))
        np.testing.assert_allclose(turned, to_floor @ axis, atol=1e-9)


def test_the_eye_of_an_unknown_mount_is_left_out():
    made = CameraDescription.of(camera(), "eye", False).model_copy(update={"height": None})
    assert [each.child for each in of_camera(made, "base_link", 0.12, 5)] == ["camera_footprint", "camera_scan"]


def test_the_base_stands_where_the_odometry_says():
    made = of_odometry(ODOMETRY, "base_link")
    assert (made.parent, made.child, made.translation) == ("odom", "base_link", (1.0, 2.0, 0.0))
    assert heading_of(made.rotation) == pytest.approx(math.pi / 2)
