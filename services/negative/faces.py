r"""A low face that was followed as if it were floor; its slow twin is tests/naive_trace.py.

Where rows lie close together, each sees a face hardly higher than the one before, as it sees a ramp. But the steepest
ramp rises with the distance and a face does not. So the height above the steepest ramp through the point below the
camera falls over floor, stays over such a ramp, and rises by all of a face:

   height                  ________ top          height above the ramp
    |                     |                        | `.
    |  floor ________face |                        |   `.      .` .
    |________________________ distance             |_____`..foot___`.__ distance
"""

import numpy as np
from numba import njit

from cliffscan.common.perception.floor_points import Metres
from cliffscan.services.negative.beam_lines import BeamLines, Rows
from cliffscan.services.negative.floor_following import End

OCCLUDED = np.float32(End.OCCLUDED)
SIGMAS = 4.0  # of noise, in which a height may err


@njit(cache=True, error_model="numpy")
def end_at_faces(
    heights: Metres,
    order: Rows,
    lines: BeamLines,
    first: Metres,
    end: Metres,
    row: Metres,
    level: Metres,
    sure: Metres,
    sure_level: Metres,
    camera_height: float,
    noise: float,
    slope: float,
    step: float,
) -> None:
    """Let the lines that were followed up a face end at its foot, OCCLUDED; in place.

    heights, order, lines: as heights_along has them; first: the row in which each line's floor comes into view; end,
    row, level, sure, sure_level: as floor_trace has them; (lines,) each; noise, slope, step: as in FloorCriteria.
    A face is higher than a step, so only a line whose last floor lies so high, and that nothing hides, is looked at.
    """
    outward = 1.0 if order[-1] > order[0] else -1.0
    for u in range(len(end)):
        if end[u] == OCCLUDED or not (row[u] >= 0.0 and level[u] > step):
            continue
        lowest, foot, foot_height = np.inf, -1.0, 0.0
        above_before, rises = np.inf, False
        for index in range(len(order)):
            at, height = float(order[index]), float(heights[index, u])
            if (at - row[u]) * outward > 0.0:
                break
            if (at - first[u]) * outward < 0.0 or height != height:
                continue
            fall = float(lines.fall[u]) + at * float(lines.fall_step[u])
            ahead = float(lines.ahead[u]) + at * float(lines.ahead_step[u])
            depth = (camera_height - height) / fall
            above = height - slope * ahead * depth
            rise = above - lowest > step + SIGMAS * noise * depth * depth * (fall + slope * ahead)
            if rise and rises:  # two in a row, as one may be chance
                end[u], row[u], level[u] = OCCLUDED, foot, foot_height
                if (sure[u] - foot) * outward > 0.0:
                    sure[u], sure_level[u] = foot, foot_height
                break
            if max(above, above_before) < lowest:  # as low as two in a row are
                lowest, foot, foot_height = max(above, above_before), at, height
            above_before, rises = above, rise
