"""The robot's frames, as REP-105 names them, from its description and its odometry."""

import math
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.camera import Floats, FloorPlane, axes
from cliffscan.common.contract.description import CameraDescription

FOOTPRINT = "camera_footprint"  # the floor's point below the camera
SCAN_FRAME = "camera_scan"  # above it
CAMERA = "camera_link"  # the camera's eye: x forward, y left, z up
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # x, y, z, w
LEVEL: Quaternion = (0.0, 0.0, 0.0, 1.0)
OPTICAL: Quaternion = (-0.5, 0.5, -0.5, 0.5)  # from forward, left, up to right, down, forward (REP-103)
FROM_OPTICAL = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])  # the same as a matrix, the other way


class Transform(NamedTuple):
    """Where a child frame stands in its parent's, at a stamp [ns]."""

    stamp: int
    parent: str
    child: str
    translation: Vector  # [m]
    rotation: Quaternion


def of_odometry(odometry: Odometry, base_frame: str) -> Transform:
    """From odom to the base."""
    x, y, theta = odometry.pose
    return Transform(odometry.stamp, odometry.frame, base_frame, (x, y, 0.0), heading(theta))


def of_camera(camera: CameraDescription, base_frame: str, scan_height: float, stamp: int) -> list[Transform]:
    """From the base to the scans' frame, `scan_height` [m] above the floor, and to the camera's eye where known."""
    place = (camera.x, camera.y, 0.0)
    known = [
        Transform(stamp, base_frame, FOOTPRINT, place, heading(camera.yaw)),
        Transform(stamp, FOOTPRINT, SCAN_FRAME, (0.0, 0.0, scan_height), LEVEL),
    ]
    if camera.height is not None and camera.pitch is not None and camera.roll is not None:
        optical = np.stack(axes(FloorPlane.from_mount(camera.height, camera.pitch, camera.roll)))
        eye = (0.0, 0.0, camera.height)
        known.append(Transform(stamp, FOOTPRINT, CAMERA, eye, quaternion(optical @ FROM_OPTICAL)))
        known.append(Transform(stamp, CAMERA, camera.frame, (0.0, 0.0, 0.0), OPTICAL))
    return known


def heading(theta: float) -> Quaternion:
    """A turn about z by theta [rad]."""
    return 0.0, 0.0, math.sin(theta / 2), math.cos(theta / 2)


def heading_of(rotation: Quaternion) -> float:
    """The turn about z [rad] of a rotation."""
    x, y, z, w = rotation
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def quaternion(matrix: Floats) -> Quaternion:
    """The quaternion of a rotation matrix (3, 3): the eigenvector of Bar-Itzhack's symmetric matrix (2000)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix
    symmetric = np.array(
        [
            [xx - yy - zz, xy + yx, xz + zx, zy - yz],
            [xy + yx, yy - xx - zz, yz + zy, xz - zx],
            [xz + zx, yz + zy, zz - xx - yy, yx - xy],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    x, y, z, w = (float(part) for part in np.linalg.eigh(symmetric)[1][:, -1])
    return (x, y, z, w) if w >= 0 else (-x, -y, -z, -w)
