"""Farthest point: the floor ends where the last floor point was seen. Paper: algorithm 1."""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.contract.beam_fields import Beams, Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.beam_reduction import NOTHING, min_per_beam
from cliffscan.common.perception.combine import beams_with
from cliffscan.common.perception.floor_points import FloorPoints, Metres
from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.services.negative.registry import negative_method


@negative_method("farthest_point", ImageScanConfig)
def find(points: FloorPoints, config: ImageScanConfig) -> Beams:
    """The method with its configuration."""
    return beams_with(farthest_point(points, config.grid(), config.floor_band), Evidence.FARTHEST_FLOOR)


def farthest_point(points: FloorPoints, grid: Grid, floor_band: float) -> Ranges:
    """Range [m] of the farthest floor point in each beam: (beams,); NaN where a beam saw no floor.

    A floor point lies within floor_band [m] of the floor plane. Paper: algorithm 1, equations (1) to (3).
    """
    return -min_per_beam(nearness(points.heights, points.distances, np.float32(floor_band)), points.region, grid)


@njit(cache=True)
def nearness(heights: Metres, distances: Metres, floor_band: np.float32) -> Metres:
    """Less the distance [m] of each pixel's point where it is floor: (rows, columns)."""
    near = np.empty_like(distances)
    for row in range(heights.shape[0]):
        for column in range(heights.shape[1]):
            height, distance = heights[row, column], distances[row, column]
            near[row, column] = -distance if abs(height) <= floor_band else NOTHING
    return near
