"""The camera, the floor and the beams: where a pixel's ray goes, seen from the floor below the camera.

Frames follow REP-103. *Optical*: x right, y down, z forward. *Scan*: origin on the floor below the camera,
x the optical axis projected on the floor, y left, z up; azimuths run counter-clockwise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEEPEST_AXIS = math.cos(math.radians(3.0))  # an optical axis nearer the vertical has no heading on the floor


class Intrinsics(NamedTuple):
    """A pinhole camera: focal lengths and principal point [px]; pixel centres have whole coordinates."""

    fx: float
    fy: float
    cx: float
    cy: float


class FloorPlane(NamedTuple):
    """The floor in the optical frame: unit normal (nx, ny, nz) pointing up, camera height d [m].

    A point p lies n·p + d metres above the floor. A level camera at 0.30 m has (0, -1, 0, 0.30).
    """

    nx: float
    ny: float
    nz: float
    d: float

    @classmethod
    def from_mount(cls, height: float, pitch: float = 0.0, roll: float = 0.0) -> FloorPlane:
        """The floor below a camera mounted `height` [m] high, `pitch` [rad] downward, rolled `roll` [rad] to the right."""
        level = math.cos(pitch)
        return cls(-math.sin(roll) * level, -math.cos(roll) * level, -math.sin(pitch), height)


@dataclass(frozen=True)
class Camera:
    """All that a depth image's pixels need to become points: the sensor and its place over the floor.

    range: (min, max) [m] along the optical axis; a depth outside it is no measurement.
    """

    width: int
    height: int
    intrinsics: Intrinsics
    range: tuple[float, float]
    floor: FloorPlane

    def reach(self) -> float:
        """Farthest horizontal distance [m] at which any pixel can measure a point."""
        forward, left = (coefficients.table() for coefficients in scan_axes(self)[:2])
        return self.range[1] * float(np.hypot(forward, left).max())


class Affine(NamedTuple):
    """A quantity of a pixel's ray that is affine in (u, v), per metre of depth: columns[u] + rows[v]."""

    columns: Floats
    rows: Floats

    def table(self) -> Floats:
        """The quantity of every pixel: (rows, columns)."""
        return self.rows[:, None] + self.columns[None, :]


def scan_axes(camera: Camera) -> tuple[Affine, Affine, Affine]:
    """How far forward, left and up a pixel's ray goes for each metre of depth, in the scan frame's directions.

    A pixel of depth z [m] lies forward·z and left·z metres from the scan's origin and up·z + d above the floor.
    """
    up = np.array(camera.floor[:3])
    forward = np.array([0.0, 0.0, 1.0]) - up[2] * up
    forward /= np.linalg.norm(forward)
    left = np.cross(up, forward)
    fx, fy, cx, cy = camera.intrinsics
    x = (np.arange(camera.width) - cx) / fx
    y = (np.arange(camera.height) - cy) / fy

    def along(axis: Floats) -> Affine:
        return Affine(axis[0] * x, axis[1] * y + axis[2])

    return along(forward), along(left), along(up)
