"""Projection: all that stands in the robot's way, brought down to the floor. Paper: positive obstacles."""

from __future__ import annotations

import numpy as np
from numba import njit

from common.grid import Grid
from common.points import Metres, Points
from common.sight import LOOKED, NOTHING, Indices, Ranges, least, sight_of


def projection(points: Points, grid: Grid, floor_band: float, robot_height: float) -> Ranges:
    """Range [m] of the nearest point above the floor band and not above the robot, in each beam: (beams,).

    +inf where a beam saw floor, or below it, and nothing in the way; NaN where it saw neither: what is higher than the
    robot tells nothing of what stands below it.
    """
    sight = sight_of(points.view, grid)
    standing = brought_down(points.heights, points.distances, sight.starts, floor_band, robot_height)
    return least(standing, sight)


@njit(cache=True)
def brought_down(heights: Metres, distances: Metres, starts: Indices, floor_band: float, robot_height: float) -> Metres:
    """The nearest such point [m] of each column, in each stretch: (stretches, columns)."""
    nearest = np.full((len(starts) - 1, heights.shape[1]), NOTHING)
    for stretch in range(len(starts) - 1):
        for row in range(starts[stretch], starts[stretch + 1]):
            for column in range(heights.shape[1]):
                height = heights[row, column]
                value = distances[row, column] if height > floor_band else LOOKED
                value = value if height <= robot_height else NOTHING
                before = nearest[stretch, column]
                nearest[stretch, column] = value if value < before else before
    return nearest
