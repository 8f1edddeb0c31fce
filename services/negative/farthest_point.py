"""Farthest point: the floor ends where the last floor point was seen. Paper: algorithm 1."""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.perception.beam_reduction import NOTHING, Indices, least, sight_of
from cliffscan.common.perception.point_heights import Metres, Points


def farthest_point(points: Points, grid: Grid, floor_band: float) -> Ranges:
    """Range [m] of the farthest floor point in each beam: (beams,); NaN where a beam saw no floor.

    A floor point lies within floor_band [m] of the floor plane. Paper: algorithm 1, equations (1) to (3).
    """
    sight = sight_of(points.view, grid)
    return -least(nearness(points.heights, points.distances, sight.starts, floor_band), sight)


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
