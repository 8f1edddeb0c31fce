"""Floor that is lost, but no hole's: what is seen beyond it tells; its slow twin is tests/naive_trace.py.

Something that hangs or stands nearer than where the floor was lost hides what is beyond: dark feet of things, and the
floor below them, return nothing. It must be low, and so in the robot's way: below a railing's bar an edge is in view.
And a shiny floor is lost in patches far off, where it is seen at a grazing angle, and goes on beyond them at its
height. A dark hole looks the same, so such floor is not known, and counts as lost as soon as it is nearer than far_off:
before it is nearer than the first floor in view, where a gate that sees floor beyond it guesses that floor leads there.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.perception.floor_points import Metres
from cliffscan.services.negative.beam_lines import BeamLines, Rows, range_in

RETURNS = 3  # beyond the lost floor, that tell what is there
SIGMAS = 4.0  # of noise, in which a height may err
LOW = 0.25  # [m] above the floor, and below the camera, what hangs is in the way; a railing's bar hides no edge
FAR_OFF = 2.0  # [m] from where on a patch may be shine
WAY = 1.0  # [m] and from the first floor in view
PATCH = 0.6  # [m] length of the longest patch that may be shine


@njit(cache=True, error_model="numpy")
def beyond_lost_floor(
    heights: Metres,
    order: Rows,
    lines: BeamLines,
    lost: NDArray[np.int64],
    floor_row: Metres,
    level: Metres,
    far_off: NDArray[np.bool_],
    camera_height: float,
    noise: float,
    step: float,
    gap: float,
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """Which of the lines `lost` show anything beyond; which are hidden by it, which go on far off as floor: (n,) each.

    heights, order, lines: as heights_along has them; floor_row and level [m] of the last floor, and whether that is
    far_off: (n,) each; noise, step, gap: as in FloorCriteria. A line may end before
    returns of a floor that falls away: there is no patch.
    """
    shows, hidden, goes_on = np.zeros(len(lost), np.bool_), np.zeros(len(lost), np.bool_), np.zeros(len(lost), np.bool_)
    outward = 1.0 if order[-1] > order[0] else -1.0
    for index in range(len(lost)):
        u, ground = lost[index], camera_height - float(level[index])
        last = range_in(lines, u, floor_row[index], ground)
        seen, above, alike = 0, 0, 0
        for at in range(len(order)):
            height = float(heights[at, u])
            if (order[at] - floor_row[index]) * outward <= 0.0 or height != height:
                continue
            fall = float(lines.fall[u]) + order[at] * float(lines.fall_step[u])
            error = step + SIGMAS * noise * camera_height * ground / fall
            off, length = height - float(level[index]), range_in(lines, u, order[at], ground) - last
            hangs = error < off < min(LOW, ground)
            above += hangs and range_in(lines, u, order[at], camera_height - height) < last
            alike += abs(off) <= error and (seen > 0 or gap < length <= PATCH)
            seen += 1
            if seen == RETURNS:
                break
        shows[index] = seen == RETURNS
        hidden[index], goes_on[index] = above == RETURNS, far_off[index] and alike == RETURNS
    return shows, hidden, goes_on


@njit(cache=True, error_model="numpy")
def far_off(lines: BeamLines, row: Metres, level: Metres, due: Metres, camera_height: float) -> NDArray[np.bool_]:
    """Whether the last floor of each line lies so far off that a robot on its way there sees it again: (lines,).

    row, level [m]: of that floor; due: the row in which each line's floor must be seen, -1 = none; (lines,) each.
    """
    far = np.zeros(len(row), np.bool_)
    for u in range(len(row)):
        if row[u] >= 0.0 and due[u] >= 0.0:
            ground = camera_height - float(level[u])
            far[u] = range_in(lines, u, row[u], ground) >= max(FAR_OFF, range_in(lines, u, due[u], ground) + WAY)
    return far
