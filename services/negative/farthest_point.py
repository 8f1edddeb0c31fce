"""Farthest point: the floor ends where the last floor point was seen. Paper: algorithm 1."""

from __future__ import annotations

import numpy as np
from numba import njit

from common.combine import Ranges
from common.points import Columns, Metres


@njit(cache=True)
def farthest_point(heights: Metres, distances: Metres, first: Columns, end: Columns, floor_band: float) -> Ranges:
    """Range [m] of the farthest floor point in each beam: (beams,); NaN where a beam saw no floor.

    The arrays are those of Points. A floor point lies within floor_band [m] of the floor plane.
    Paper: algorithm 1, equations (1) to (3).
    """
    rows, beams = first.shape
    farthest = np.full(beams, np.nan)
    for row in range(rows):
        for beam in range(beams):
            for column in range(first[row, beam], end[row, beam]):
                distance = distances[row, column]
                if abs(heights[row, column]) <= floor_band and not distance <= farthest[beam]:
                    farthest[beam] = distance
    return farthest.astype(np.float32)
