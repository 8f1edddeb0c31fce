"""A depth image as points seen from the floor: how high each lies above it, and how far away."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera
from cliffscan.common.perception.image_region import ImageRegion, Millimetres, image_region

Metres = NDArray[np.float32]

MILLIMETRE = 0.001
METRES = np.float32(MILLIMETRE)  # in one
FARTHEST = np.iinfo(np.uint16).max  # [mm]


class PointHeights(NamedTuple):
    """What a depth image tells of the floor; pixels without a usable return have height NaN."""

    heights: Metres  # (rows, columns) [m] above the floor plane
    distances: Metres  # (rows, columns) [m] along the floor, from the point below the camera
    region: ImageRegion  # the part of the image that these are


def point_heights(
    depth: Millimetres, camera: Camera, range_min: float = 0.0, lower_than: float = math.inf
) -> PointHeights:
    """The points of the rows of `depth` (rows, columns) [mm] that can show anything lower than `lower_than` [m].

    Depths outside the sensor's range and points nearer than range_min [m], parts of the robot, are left out.
    """
    region = image_region(camera, lower_than)
    near, far = (np.uint16(min(round(limit / MILLIMETRE), FARTHEST)) for limit in camera.range)
    heights, distances = _measure(
        region.of(depth),
        region.up.single(),
        region.forward.single(),
        region.left.single(),
        np.float32(camera.floor.d),
        max(near, np.uint16(1)),
        far,
        np.float32(range_min),
    )
    return PointHeights(heights, distances, region)


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
    """Heights and distances of all pixels, in one pass over the image."""
    heights, distances = np.empty(millimetres.shape, np.float32), np.empty(millimetres.shape, np.float32)
    for row in range(millimetres.shape[0]):
        for column in range(millimetres.shape[1]):
            depth = np.float32(millimetres[row, column]) * METRES
            ahead = forward.columns[column] + forward.rows[row]
            aside = left.columns[column] + left.rows[row]
            distance = depth * np.sqrt(ahead * ahead + aside * aside)  # equation (3)
            height = depth * (up.columns[column] + up.rows[row]) + camera_height
            usable = (near <= millimetres[row, column]) & (millimetres[row, column] <= far)
            usable = usable & (ahead > 0) & (distance >= range_min)
            heights[row, column] = height if usable else np.nan
            distances[row, column] = distance
    return heights, distances
