"""The camera, the floor and the beams: where a pixel's ray goes, seen from the floor below the camera.

Frames follow REP-103. *Optical*: x right, y down, z forward. *Scan*: origin on the floor below the camera,
x the optical axis projected on the floor, y left, z up; azimuths run counter-clockwise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.limits import (
    DEEPEST,
    FARTHEST_REACH,
    HIGHEST_CAMERA,
    LEAST_NOISE,
    LOWEST_CAMERA,
    MOST_NOISE,
    MOST_PIXELS,
    MOST_SIDE,
    NEAREST_REACH,
    WIDEST_BASELINE,
)

Floats = NDArray[np.float64]
Floating = NDArray[np.floating[Any]]  # of either precision

KINECT_NOISE = 1.65e-3  # [1/m] 1.425e-3 of noise with the rounding to steps of 2.85e-3
KINECT_BASELINE = 0.075  # [m] between its camera and its projector
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
        """The floor below a camera `height` [m] high, looking `pitch` [rad] down, rolled `roll` [rad] right."""
        level = math.cos(pitch)
        return cls(-math.sin(roll) * level, -math.cos(roll) * level, -math.sin(pitch), height)

    def mount(self) -> tuple[float, float, float]:
        """The camera's height [m], pitch and roll [rad]: what from_mount makes this floor of."""
        return self.d, math.atan2(-self.nz, math.hypot(self.nx, self.ny)), math.atan2(-self.nx, -self.ny)


class Region(NamedTuple):
    """The pixels that can carry a return at all: from the first column and row up to and with the last."""

    first_column: int
    first_row: int
    last_column: int
    last_row: int

    @classmethod
    def whole(cls, width: int, height: int) -> Region:
        """All pixels of an image."""
        return cls(0, 0, width - 1, height - 1)

    @classmethod
    def part(cls, corners: tuple[int, int, int, int] | None, width: int, height: int) -> Region | None:
        """The region of these corners, None where it is all of the image: what Camera takes."""
        return None if corners is None or corners == cls.whole(width, height) else cls(*corners)


@dataclass(frozen=True)
class Camera:
    """All that a depth image's pixels need to become points: the sensor and its place over the floor.

    range: (min, max) [m] along the optical axis; a depth outside it is no measurement. noise [1/m]: standard deviation
    of the inverse depth, steps included; baseline [m]: between the sensor's two eyes, or its eye and its projector;
    seen: the pixels that can carry a return, None = all.
    """

    width: int
    height: int
    intrinsics: Intrinsics
    range: tuple[float, float]
    floor: FloorPlane
    noise: float = KINECT_NOISE
    baseline: float = KINECT_BASELINE
    seen: Region | None = None

    @property
    def region(self) -> Region:
        """The pixels that can carry a return."""
        return self.seen or Region.whole(self.width, self.height)

    def cropped(self, region: Region) -> Camera:
        """The camera of a part of the image: its pixels are counted from the region's first."""
        left, top, right, bottom = region
        fx, fy, cx, cy = self.intrinsics
        shifted = Intrinsics(fx, fy, cx - left, cy - top)
        return replace(self, width=right + 1 - left, height=bottom + 1 - top, intrinsics=shifted, seen=None)


def axes(floor: FloorPlane) -> tuple[Floats, Floats, Floats]:
    """The scan frame's forward, left and up in the optical frame: unit vectors (3,)."""
    up = np.array(floor[:3]) / np.linalg.norm(floor[:3])
    forward = np.array([0.0, 0.0, 1.0]) - up[2] * up
    forward /= np.linalg.norm(forward)
    return forward, _cross(up, forward), up


def _cross(a: Floats, b: Floats) -> Floats:
    """The cross product of two vectors (3,): np.cross, which looks for axes first, takes fifteen times as long."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


class Affine(NamedTuple):
    """A quantity of a pixel's ray that is affine in (u, v), per metre of depth: columns[u] + rows[v]."""

    columns: Floating
    rows: Floating

    def table(self) -> Floats:
        """The quantity of every pixel: (rows, columns)."""
        return self.rows[:, None] + self.columns[None, :]

    def single(self, sign: float = 1.0) -> Affine:
        """The same, or with sign -1 the opposite, in single precision."""
        return Affine((sign * self.columns).astype(np.float32), (sign * self.rows).astype(np.float32))


@lru_cache(maxsize=16)  # all that is made of an image asks for it
def scan_axes(camera: Camera) -> tuple[Affine, Affine, Affine]:
    """How far forward, left and up a pixel's ray goes for each metre of depth, in the scan frame's directions.

    A pixel of depth z [m] lies forward·z and left·z metres from the scan's origin and up·z + d above the floor.
    """
    forward, left, up = axes(camera.floor)
    fx, fy, cx, cy = camera.intrinsics
    x = (np.arange(camera.width) - cx) / fx
    y = (np.arange(camera.height) - cy) / fy

    def along(axis: Floats) -> Affine:
        return Affine(axis[0] * x, axis[1] * y + axis[2])

    return along(forward), along(left), along(up)


def reach(camera: Camera) -> float:
    """Farthest horizontal distance [m] at which any pixel of `camera` can measure a point: a corner's, by convexity."""
    forward, left, _ = scan_axes(camera)
    corners = (
        np.hypot(forward.columns[column] + forward.rows[row], left.columns[column] + left.rows[row])
        for column in (0, -1)
        for row in (0, -1)
    )
    return camera.range[1] * float(max(corners))


def check_camera(camera: Camera) -> None:
    """Raise ValueError where no real camera can be so, or where its axis has no heading on the floor."""
    sides = camera.width, camera.height
    if min(sides) < 2 or max(sides) > MOST_SIDE or camera.width * camera.height > MOST_PIXELS:
        given = f"{camera.width}x{camera.height}"
        raise ValueError(f"width, height: {given}, expected 2 to {MOST_SIDE} each and {MOST_PIXELS} pixels in all")
    fx, fy, cx, cy = camera.intrinsics
    for name, focal, centre, size in (("x", fx, cx, camera.width), ("y", fy, cy, camera.height)):
        if not 0.1 * size <= focal <= 100.0 * size:
            raise ValueError(f"intrinsics: f{name} of {focal} px is impossible for {size} pixels")
        if not -size <= centre <= 2 * size:
            raise ValueError(f"intrinsics: c{name} of {centre} px is impossible for {size} pixels")
    left, top, right, bottom = camera.region
    if not (0 <= left < right < camera.width and 0 <= top < bottom < camera.height):
        told = f"{list(camera.region)}, expected first column, first row, last column, last row"
        raise ValueError(f"region: {told} of an image of {camera.width}x{camera.height}")
    if not LEAST_NOISE <= camera.noise <= MOST_NOISE:
        raise ValueError(f"noise: {camera.noise} is impossible, expected {LEAST_NOISE} to {MOST_NOISE} [1/m]")
    if not 0.0 <= camera.baseline <= WIDEST_BASELINE:
        raise ValueError(f"baseline: {camera.baseline} is impossible, expected 0 to {WIDEST_BASELINE} [m]")
    near, far = camera.range
    if not (0.0 <= near < far and near < DEEPEST and NEAREST_REACH <= far <= FARTHEST_REACH):
        raise ValueError(f"range: [{near}, {far}] m is impossible; is it in millimetres? Give metres")
    *normal, height = camera.floor
    if abs(math.hypot(*normal) - 1.0) > 0.01:
        raise ValueError(f"floor: the normal has length {math.hypot(*normal):.3f}, expected 1")
    if abs(camera.floor.nz) > STEEPEST_AXIS:
        raise ValueError("floor: the camera looks straight down or up, so its axis has no heading on the floor")
    if not LOWEST_CAMERA <= height <= HIGHEST_CAMERA:
        raise ValueError(f"floor: a camera height of {height} m is impossible")
