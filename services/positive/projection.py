"""Projection: all that stands in the robot's way, brought down to the floor. Paper: positive obstacles.

What stands on a ramp is told from the ramp by following the floor outward: from one point of it to the next it rises by
no more than the steepest floor does, while a face rises at once.

The noise of a sensor's inverse depth is constant, so that of a height grows with the depth, and with it the band that
counts as floor: what is lower than the noise is no obstacle.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.perception.beam_reduction import LOOKED, NOTHING, min_per_beam
from cliffscan.common.perception.floor_points import MILLIMETRE, FloorPoints, Metres
from cliffscan.common.perception.image_region import Millimetres
from cliffscan.common.perception.low_steps import Sight
from cliffscan.services.positive.first_sight import first_floor
from cliffscan.services.positive.low_rises import mark_rises

ACROSS = np.float32(0.2)  # [m] of unseen floor over which it may rise
CLOSE = np.float32(0.02)  # [m] above a ramp, from where on a point is no longer taken for one
ZERO = np.float32(0.0)
DEVIATIONS = 5.0  # of a height, up to which it is noise: four make ten obstacles of a frame's 300,000 pixels


def projection(
    points: FloorPoints,
    grid: Grid,
    floor_band: float,
    robot_height: float,
    slope: float,
    noise: float,
    wheel_step: float = 0.0,
) -> Ranges:
    """Range [m] of the nearest point above the floor and not above the robot, in each beam: (beams,).

    floor_band [m] above the floor that was followed is floor, or what noise may make of it; slope: rise per metre of
    the steepest one; noise [1/m]: standard deviation of the inverse depth; both are 0 for the paper's, which is flat
    and exact; robot_height [m] above the floor plane; wheel_step [m]: what the wheels take of a step, 0 for the
    paper's, which looks for none. +inf where a beam saw floor, or below it, and nothing in the way; NaN where it saw
    neither: what is higher than the robot tells nothing of what stands below it.
    """
    outward = 1 if points.region.up.rows[0] < points.region.up.rows[1] else -1
    band, height, steepest = np.float32(floor_band), np.float32(robot_height), np.float32(slope)
    level, seen = first_floor(points.heights, points.distances, outward, band, steepest)
    uncertain = np.float32(DEVIATIONS * noise * points.region.camera.floor.d * MILLIMETRE)
    standing = brought_down(
        points.millimetres, points.heights, points.distances, outward, band, uncertain, height, steepest, level, seen
    )
    if wheel_step:
        mark_rises(standing, points, outward, Sight.of(points.region, wheel_step, slope))
    return min_per_beam(standing, points.region, grid)


@njit(cache=True)
def brought_down(
    millimetres: Millimetres,
    heights: Metres,
    distances: Metres,
    outward: int,
    floor_band: np.float32,
    uncertain: np.float32,
    robot_height: np.float32,
    slope: np.float32,
    level: Metres,
    seen: Metres,
) -> Metres:
    """How far away [m] each pixel's point is where it stands in the way: (rows, columns).

    outward: 1 where rows lead away from the robot, or -1; uncertain: how far [m] noise may take a height at one
    millimetre of depth; level, seen [m]: how high the floor of each column is and how
    far it was seen, (columns,) each; they are kept up to date in place.
    """
    rows, columns = heights.shape
    standing = np.empty_like(distances)
    for index in range(rows):
        row = index if outward > 0 else rows - 1 - index
        for column in range(columns):
            height, distance, lv, far = heights[row, column], distances[row, column], level[column], seen[column]
            further = max(distance, far) - far
            highest = lv + slope * min(further, ACROSS)
            band = max(floor_band, uncertain * np.float32(millimetres[row, column]))
            limit = highest + band
            value = distance if height > limit else LOOKED
            standing[row, column] = value if height <= robot_height else NOTHING
            floor = (height <= limit) & (height >= -band)
            here = min(max(height, ZERO), highest)
            # without `+ ZERO` the compiler makes masked stores of it, which are slow on some processors
            level[column] = here if floor & (height <= highest + CLOSE) else lv + ZERO
            seen[column] = far + (further if floor else ZERO)
    return standing
