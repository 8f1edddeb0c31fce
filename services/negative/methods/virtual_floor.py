"""Virtual floor projection: what lies below the floor is seen through a hole in it. Paper: algorithm 2."""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.contract.beam_fields import Beams, Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.beam_reduction import LOOKED, NOTHING, min_per_beam
from cliffscan.common.perception.combine import beams_with
from cliffscan.common.perception.floor_points import FloorPoints, Metres
from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.services.negative.registry import negative_method


@negative_method("virtual_floor", ImageScanConfig)
def find(points: FloorPoints, config: ImageScanConfig) -> Beams:
    """The method with its configuration."""
    return beams_with(virtual_floor(points, config.grid(), config.floor_band), Evidence.DROP)


def virtual_floor(points: FloorPoints, grid: Grid, floor_band: float) -> Ranges:
    """Range [m] of the nearest point below the floor, moved along its ray up to the floor: (beams,).

    Below the floor means by more than floor_band [m]. +inf where floor and nothing below it was seen, NaN where
    neither was. Paper: algorithm 2, equations (4) and (5).
    """
    band, height = np.float32(floor_band), np.float32(points.region.camera.floor.d)
    moved = projected(points.heights, points.distances, band, height)
    return min_per_beam(moved, points.region, grid)


@njit(cache=True, error_model="numpy")
def projected(heights: Metres, distances: Metres, floor_band: np.float32, camera_height: np.float32) -> Metres:
    """How far [m] each pixel's point is once it is moved: (rows, columns)."""
    moved = np.empty_like(distances)
    for row in range(heights.shape[0]):
        for column in range(heights.shape[1]):
            height, distance = heights[row, column], distances[row, column]
            share = camera_height / (camera_height - height)  # y'/y: x moves by equation (4), y by (5)
            value = distance * share if height < -floor_band else LOOKED
            moved[row, column] = value if height <= floor_band else NOTHING
    return moved
