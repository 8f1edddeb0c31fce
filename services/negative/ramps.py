"""A ramp down whose crest lies so far ahead that a few rows see it, far apart; its slow twin is tests/naive_trace.py.

No row by itself tells such a ramp from the far side of a hole. All that a line sees beyond its last floor does. Along a
line the inverse depth of a plane is affine in how far the ray falls per metre of depth, its noise is constant, and it
is 0 where the ray falls as the plane does:

   inverse depth                              o  seen
    |            o o  floor
    |          o'                  ramp: begins where the floor ended, 0 at its incline
    |        o
    |      o                       level floor beyond a kerb: begins lower, 0 at the horizon
    |____o______________________
         incline   fall per metre
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, Floats
from cliffscan.common.perception.floor_points import Metres
from cliffscan.services.negative.beam_lines import BeamLines, Rows

SHARP = 0.075  # [px] of disparity, by which a Kinect errs at most; what errs by more smears edges over its window
SIGMAS = 4.0  # of noise, within which a surface explains an inverse depth
LEAST_ROWS = 3  # that show a ramp,
LEAST_SHARE = 0.7  # and of those that would


def resolves_ramps(camera: Camera) -> bool:
    """Whether the camera sees edges sharply: a smeared one looks like a ramp."""
    return camera.noise * camera.baseline * camera.intrinsics.fx <= SHARP


@njit(cache=True, error_model="numpy")
def ramps_ahead(
    heights: Metres,
    order: Rows,
    lines: BeamLines,
    some: NDArray[np.int64],
    floor_row: Metres,
    camera_height: float,
    reach: float,
    noise: float,
    slope: float,
    grazing: float,
) -> NDArray[np.bool_]:
    """Whether all that is seen beyond the last floor of some lines is a ramp down that begins there: (n,).

    heights, order, lines: as heights_along has them; some: lines, and floor_row: the row of the last floor of each,
    (n,); camera_height, reach of the sensor [m]; noise, slope, grazing: as in FloorCriteria. Nearer than where the
    sensor would graze the steepest ramp it sees all of it, and floor_trace follows it.
    """
    ramps = np.zeros(len(some), np.bool_)
    falls, inverse = np.empty(len(order)), np.empty(len(order))
    for index in range(len(some)):
        u, first = some[index], len(order) - 1
        while first >= 0 and order[first] != floor_row[index]:
            first -= 1
        if first < 0 or float(lines.fall[u]) + order[first] * float(lines.fall_step[u]) > slope + grazing:
            continue
        for row in range(first, len(order)):
            falls[row] = float(lines.fall[u]) + order[row] * float(lines.fall_step[u])
            inverse[row] = falls[row] / (camera_height - heights[row, u])
        ramps[index] = is_ramp(falls[first:], inverse[first:], reach, SIGMAS * noise, slope)
    return ramps


@njit(cache=True, error_model="numpy")
def is_ramp(falls: Floats, inverse: Floats, reach: float, error: float, slope: float) -> bool:
    """Whether a ramp explains the inverse depths [1/m], but for an error of them, and a level floor does not.

    falls: what the rays lose in height per metre of depth, (n,), the first of them to the last floor; NaN = no return.
    """
    seen, gain, incline, level = fit_planes(falls[1:], inverse[1:])
    if seen < LEAST_ROWS or not 0.0 < incline <= slope:
        return False
    off_ramp, off_level, due = 0.0, 0.0, 0
    for row in range(1, len(falls)):
        ramp = gain * (falls[row] - incline)
        due += ramp * reach >= 1.0
        if inverse[row] == inverse[row]:
            off_ramp = max(off_ramp, abs(inverse[row] - ramp))
            off_level = max(off_level, abs(inverse[row] - level * falls[row]))
    begins = gain * (falls[0] - incline) >= inverse[0] - error
    return begins and off_ramp <= error < off_level and seen >= LEAST_SHARE * due


@njit(cache=True, error_model="numpy")
def fit_planes(falls: Floats, inverse: Floats) -> tuple[int, float, float, float]:
    """How many returns there are; by least squares gain and incline of a ramp, and the gain of a level floor."""
    many, x, y = 0, 0.0, 0.0
    for row in range(len(falls)):
        if inverse[row] == inverse[row]:
            many, x, y = many + 1, x + falls[row], y + inverse[row]
    x, y, xx, xy = x / many, y / many, 0.0, 0.0
    for row in range(len(falls)):
        if inverse[row] == inverse[row]:
            xx += (falls[row] - x) * (falls[row] - x)
            xy += (falls[row] - x) * (inverse[row] - y)
    gain = xy / xx
    return many, gain, x - y / gain, (xy + many * x * y) / (xx + many * x * x)
