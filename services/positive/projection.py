"""Projection: all that stands in the robot's way, brought down to the floor. Paper: positive obstacles."""

from __future__ import annotations

import numpy as np
from numba import njit

from common.combine import Ranges
from common.points import Columns, Metres


@njit(cache=True)
def projection(
    heights: Metres, distances: Metres, first: Columns, end: Columns, floor_band: float, robot_height: float
) -> Ranges:
    """Range [m] of the nearest point above the floor band and not above the robot, in each beam: (beams,).

    The arrays are those of Points. +inf where a beam saw floor, or below it, and nothing in the way; NaN where it saw
    neither: what is higher than the robot tells nothing of what stands below it.
    """
    rows, beams = first.shape
    nearest = np.full(beams, np.nan)
    for row in range(rows):
        for beam in range(beams):
            for column in range(first[row, beam], end[row, beam]):
                height = heights[row, column]
                if not height <= robot_height:
                    continue
                distance = distances[row, column] if height > floor_band else np.inf
                if not distance >= nearest[beam]:
                    nearest[beam] = distance
    return nearest.astype(np.float32)
