"""A depth image as points seen from the floor: how high each lies above it, and how far away."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera
from cliffscan.common.perception.image_region import ImageRegion, Millimetres, image_region

Metres = NDArray[np.float32]

MILLIMETRE = 0.001
METRES = np.float32(MILLIMETRE)  # in one
FARTHEST = np.iinfo(np.uint16).max  # [mm]


@dataclass(frozen=True, eq=False)
class FloorPoints:
    """What a depth image tells of the floor; its points are computed when they are first asked for."""

    depth: Millimetres  # (rows, columns) [mm], the whole image
    region: ImageRegion  # the part of it that is looked at
    range_min: float  # [m] along the floor; nearer points are parts of the robot

    @cached_property
    def usable(self) -> tuple[np.uint16, np.uint16]:
        """The least and the largest depth [mm] that is a measurement."""
        near, far = (np.uint16(min(round(limit / MILLIMETRE), FARTHEST)) for limit in self.region.camera.range)
        return max(near, np.uint16(1)), far

    @cached_property
    def millimetres(self) -> Millimetres:
        """The depths [mm] of the region's pixels: (rows, columns)."""
        return read_only(self.region.of(self.depth))

    @property
    def heights(self) -> Metres:
        """Above the floor plane [m], of the region's pixels (rows, columns); NaN without a usable return."""
        return self._points[0]

    @property
    def distances(self) -> Metres:
        """Along the floor [m], from the point below the camera: (rows, columns)."""
        return self._points[1]

    @cached_property
    def _points(self) -> tuple[Metres, Metres]:
        region = self.region
        return _measure(
            self.millimetres,
            region.up,
            region.forward,
            region.left,
            np.float32(region.camera.floor.d),
            *self.usable,
            np.float32(self.range_min),
        )


def floor_points(
    depth: Millimetres, camera: Camera, range_min: float = 0.0, lower_than: float = math.inf
) -> FloorPoints:
    """The points of the rows of `depth` (rows, columns) [mm] that can show anything lower than `lower_than` [m].

    Depths outside the sensor's range and points nearer than range_min [m], parts of the robot, are left out.
    """
    return FloorPoints(read_only(depth), image_region(camera, lower_than), range_min)


def read_only(depth: Millimetres) -> Millimetres:
    """The same depths as an array of one type, wherever they come from: numba compiles a kernel for each type."""
    view = depth.view()
    view.flags.writeable = False
    return view


@njit(cache=True, error_model="numpy")
def _measure(
    millimetres: Millimetres,
    up: Affine,
    forward: Affine,
    left: Affine,
    camera_height: np.float32,
    near: np.uint16,
    far: np.uint16,
    range_min: np.float32,
) -> tuple[Metres, Metres]:
    """Heights and distances of all pixels, in one pass over the image and in single precision."""
    heights, distances = np.empty(millimetres.shape, np.float32), np.empty(millimetres.shape, np.float32)
    ups, aheads = up.columns.astype(np.float32), forward.columns.astype(np.float32)
    asides = left.columns.astype(np.float32)
    nearest, farthest = np.float32(near), np.float32(far)
    for row in range(millimetres.shape[0]):
        up_row, ahead_row = np.float32(up.rows[row]), np.float32(forward.rows[row])
        aside_row = np.float32(left.rows[row])
        for column in range(millimetres.shape[1]):
            raw = np.float32(millimetres[row, column])
            depth = raw * METRES
            ahead, aside = aheads[column] + ahead_row, asides[column] + aside_row
            distance = depth * np.sqrt(ahead * ahead + aside * aside)  # equation (3)
            height = depth * (ups[column] + up_row) + camera_height
            usable = (nearest <= raw) & (raw <= farthest) & (ahead > np.float32(0.0)) & (distance >= range_min)
            heights[row, column] = height if usable else np.nan
            distances[row, column] = distance
    return heights, distances
