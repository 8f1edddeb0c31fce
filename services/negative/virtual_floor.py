"""Virtual floor projection: what lies below the floor is seen through a hole in it. Paper: algorithm 2."""

from __future__ import annotations

import numpy as np
from numba import njit

from common.combine import Ranges
from common.points import Columns, Metres


@njit(cache=True)
def virtual_floor(
    heights: Metres, distances: Metres, first: Columns, end: Columns, floor_band: float, camera_height: float
) -> Ranges:
    """Range [m] of the nearest point below the floor, moved along its ray up to the floor: (beams,).

    The arrays are those of Points; below the floor means by more than floor_band [m]. +inf where floor and nothing
    below it was seen, NaN where neither was. Paper: algorithm 2, equations (4) and (5).
    """
    rows, beams = first.shape
    nearest = np.full(beams, np.nan)
    for row in range(rows):
        for beam in range(beams):
            for column in range(first[row, beam], end[row, beam]):
                height = heights[row, column]
                if height < -floor_band:
                    moved = distances[row, column] * camera_height / (camera_height - height)  # y'/y of equation (4)
                elif height <= floor_band:
                    moved = np.inf
                else:
                    continue
                if not moved >= nearest[beam]:
                    nearest[beam] = moved
    return nearest.astype(np.float32)
