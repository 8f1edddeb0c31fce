"""The floor where it comes into view, which is not the robot's own when it stands before a ramp.

What is seen first may lie above the floor plane because a ramp began nearer than the camera sees, or because it belongs
to a thing. A ramp goes on rising as it must have from its foot, which lies beyond the camera; a top rises less, and a
face more.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.perception.floor_points import Metres

BASE = np.float32(1 / 3)  # of the distance, over which a ramp shows that it goes on rising
UNEVEN = np.float32(0.004)  # [m] that its points may be off


@njit(cache=True, error_model="numpy")
def first_floor(
    heights: Metres, distances: Metres, outward: int, floor_band: np.float32, slope: np.float32
) -> tuple[Metres, Metres]:
    """How high [m] the floor is where each column first sees it, and how far away [m] that is: (columns,) each.

    heights, distances [m]: (rows, columns) as FloorPoints has them; outward: 1 where rows lead away from the robot, or
    -1; slope: rise per metre of the steepest floor. 0 m high where no ramp comes into view, and where it is so low that
    it lies in half of floor_band [m] above the plane.
    """
    rows, columns = heights.shape
    level, seen = np.zeros(columns, np.float32), np.zeros(columns, np.float32)
    for column in range(columns):
        height = np.float32(0.0)
        for index in range(rows):
            row = index if outward > 0 else rows - 1 - index
            above, distance = heights[row, column], distances[row, column]
            if above != above:
                continue
            if seen[column] == 0.0:
                height, seen[column] = above, distance
                if not floor_band / 2 < height <= slope * distance:
                    break
            further, rise = distance - seen[column], above - height
            if rise > further * slope + UNEVEN:
                break
            if further >= seen[column] * BASE:
                if rise >= further * height / seen[column] - UNEVEN:
                    level[column] = height
                break
    return level, seen
