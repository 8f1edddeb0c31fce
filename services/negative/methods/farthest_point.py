"""Farthest point: the floor ends where the last floor point was seen. Paper: algorithm 1."""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.contract.beam_fields import Beams, Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.beam_reduction import NOTHING, Indices, beam_reduction, min_per_beam
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
    reduction = beam_reduction(points.region, grid)
    return -min_per_beam(nearness(points.heights, points.distances, reduction.starts, floor_band), reduction)


@njit(cache=True)
def nearness(heights: Metres, distances: Metres, starts: Indices, floor_band: float) -> Metres:
    """Less the distance [m] of the farthest floor point of each column, in each stretch: (stretches, columns)."""
    farthest = np.full((len(starts) - 1, heights.shape[1]), NOTHING)
    for stretch in range(len(starts) - 1):
        for row in range(starts[stretch], starts[stretch + 1]):
            for column in range(heights.shape[1]):
                floor = abs(heights[row, column]) <= floor_band
                value = -distances[row, column] if floor else NOTHING
                before = farthest[stretch, column]
                farthest[stretch, column] = value if value < before else before
    return farthest
