"""What the traces along the lines come to: where each ended, and which ends are to be believed."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.common.perception.floor_points import Metres
from cliffscan.services.negative.beam_lines import BeamLines, range_in
from cliffscan.services.negative.floor_following import End

DROP, NO_RETURN, UNVERIFIED = np.float32(End.DROP), np.float32(End.NO_RETURN), np.float32(End.UNVERIFIED)
SIDE = 4  # lines to either side whose floor levels a line's is averaged with,
AGREE = 0.01  # [m] if they agree so well: noise in the level is noise in the edge
NARROWEST = 0.03  # [m] what fewer lines side by side saw is noise,
NARROWEST_FAR = 0.15  # [m] or floor that is lost far off, where shine takes patches of it


@njit(cache=True, error_model="numpy")
def locate_edges(
    end: Metres, row: Metres, level: Metres, sure: Metres, sure_level: Metres, lines: BeamLines, camera_height: float
) -> tuple[Floats, Floats]:
    """Range [m] where the floor ends along each line, and up to which it was sure; (lines,), 0 m where it never was.

    end, row, level, sure, sure_level: as floor_trace has them.
    """
    ranges, clear = np.zeros(len(end)), np.zeros(len(end))
    for u in range(len(end)):
        height = float(level[u])
        if (end[u] == DROP or end[u] == NO_RETURN) and row[u] >= 0:
            total, many = 0.0, 0
            for other in range(max(u - SIDE, 0), min(u + SIDE + 1, len(end))):
                alike = (end[other] == DROP or end[other] == NO_RETURN) and row[other] >= 0
                total += level[other] if alike else 0.0
                many += alike
            height = total / many if abs(total / many - level[u]) < AGREE else height
        if row[u] >= 0:
            ranges[u] = range_in(lines, u, row[u], camera_height - height)
        if sure[u] >= 0:
            below = camera_height - float(sure_level[u])
            clear[u] = ranges[u] if sure[u] == row[u] else range_in(lines, u, sure[u], below)
    return ranges, clear


@njit(cache=True)
def reject_unreliable(
    end: Metres,
    ranges: Floats,
    in_view: Metres,
    far_off: NDArray[np.bool_],
    spacing: float,
    alone: bool,
    lost_counts: bool,
) -> None:
    """Make UNVERIFIED, in place, what too few lines side by side saw, and floor lost that is not to count.

    ranges [m] of the lines, in_view: a row or -1, for lines outside the image, far_off: as lost_floor has it, where
    something is seen beyond: (lines,) each; spacing [rad] between lines; lost_counts: whether floor lost counts, and
    alone: whether it does without a drop that is seen beside it.
    """
    first, many = 0, len(end)
    while first < many:
        stop, across, drop, far = first, 0.0, False, True
        while stop < many and (end[stop] == DROP or end[stop] == NO_RETURN):
            across, drop, far = across + spacing * ranges[stop], drop or end[stop] == DROP, far and far_off[stop]
            stop += 1
        within = first > 0 and stop < many and in_view[first - 1] >= 0 and in_view[stop] >= 0
        narrow = within and across < (NARROWEST_FAR if far and not drop else NARROWEST)
        ignored = not lost_counts or not (alone or drop)
        for u in range(first, stop):
            if narrow or (ignored and end[u] == NO_RETURN):
                end[u] = UNVERIFIED
        first = stop + 1
