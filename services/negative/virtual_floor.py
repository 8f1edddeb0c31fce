"""Virtual floor projection: what lies below the floor is seen through a hole in it. Paper: algorithm 2."""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.perception.beam_reduction import LOOKED, NOTHING, Indices, least, sight_of
from cliffscan.common.perception.point_heights import Metres, Points


def virtual_floor(points: Points, grid: Grid, floor_band: float) -> Ranges:
    """Range [m] of the nearest point below the floor, moved along its ray up to the floor: (beams,).

    Below the floor means by more than floor_band [m]. +inf where floor and nothing below it was seen, NaN where
    neither was. Paper: algorithm 2, equations (4) and (5).
    """
    sight = sight_of(points.view, grid)
    band, height = np.float32(floor_band), np.float32(points.view.camera.floor.d)
    moved = projected(points.heights, points.distances, sight.starts, band, height)
    return least(moved, sight)


@njit(cache=True, error_model="numpy")
def projected(
    heights: Metres, distances: Metres, starts: Indices, floor_band: np.float32, camera_height: np.float32
) -> Metres:
    """The nearest moved point [m] of each column, in each stretch: (stretches, columns)."""
    nearest = np.full((len(starts) - 1, heights.shape[1]), NOTHING)
    for stretch in range(len(starts) - 1):
        for row in range(starts[stretch], starts[stretch + 1]):
            for column in range(heights.shape[1]):
                height = heights[row, column]
                share = camera_height / (camera_height - height)  # y'/y of equation (4)
                value = distances[row, column] * share if height < -floor_band else LOOKED
                value = value if height <= floor_band else NOTHING
                before = nearest[stretch, column]
                nearest[stretch, column] = value if value < before else before
    return nearest
