"""Lines that come into view through a side of the image: of the floor before, only the lines beside tell.

A camera that leans sees floor at its border far off first. A line there goes on from the lines beside it, as far as
they saw floor to where it comes into view. Beyond the first that does not, nobody knows what the others missed.

        image            |
   . . . . . . . . . .  /|
     |   |   |   |   | / |   the last line comes into view here,
     |   |   |   |   |/  |
     |___|___|___|   /___|   and beside it the floor had ended before
     |   |   |   |  /|   |
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.common.perception.floor_points import Metres
from cliffscan.services.negative.beam_lines import BESIDE, BeamLines, Rows, range_in
from cliffscan.services.negative.floor_following import End

REACHED_RANGE, UNVERIFIED = np.float32(End.REACHED_RANGE), np.float32(End.UNVERIFIED)
BEFORE = 4  # lines beside, of which the one that saw farthest tells: a speck in one is no end of floor


@njit(cache=True, error_model="numpy")
def end_at_border(
    end: Metres, clear: Floats, lines: BeamLines, first: Metres, order: Rows, columns: int, camera_height: float
) -> None:
    """Let nothing be clear beyond where no line beside saw floor, in place.

    end: as floor_trace has it; clear [m]: as locate_edges has it; lines, order: as heights_along has them; first: the
    row in which each line's floor comes into view; columns: how many the region has.
    """
    in_view = np.flatnonzero(first >= 0.0)
    many = len(in_view)
    for outward in (1, -1):
        outermost = many - 1 if outward > 0 else 0
        place = _nearest_place(in_view, outward, lines, first, order, columns, camera_height)
        limit = np.inf
        while place != outermost:
            place += outward
            u = in_view[place]
            known = 0.0
            for before in range(1, BEFORE + 1):
                inner = place - before * outward
                if 0 <= inner < many:
                    other = in_view[inner]
                    known = max(known, np.inf if end[other] == REACHED_RANGE else clear[other])
            limit = min(limit, known) if range_in(lines, u, first[u], camera_height) > known else limit
            if limit < np.inf:
                clear[u] = min(clear[u], limit)
                end[u] = UNVERIFIED if end[u] == REACHED_RANGE else end[u]


@njit(cache=True, error_model="numpy")
def _nearest_place(
    in_view: NDArray[np.int64],
    outward: int,
    lines: BeamLines,
    first: Metres,
    order: Rows,
    columns: int,
    camera_height: float,
) -> int:
    """Inward from one border, the place of the line that comes into view the nearest: none farther in enters there."""
    many = len(in_view)
    walked = many - 1 if outward > 0 else 0
    place, nearest = walked, np.inf
    while 0 <= walked < many:
        u = in_view[walked]
        entry = range_in(lines, u, first[u], camera_height)
        if entry < nearest:
            place, nearest = walked, entry
        if not _enters_at_side(lines, u, first[u], order, columns):
            break
        walked -= outward
    return place


@njit(cache=True, error_model="numpy")
def _enters_at_side(lines: BeamLines, u: int, first: float, order: Rows, columns: int) -> bool:
    """Whether a line is beside the image in the row before the first in which its floor is in view."""
    before = order[0]
    for at in order:
        if at == first:
            break
        before = at
    across = float(lines.column[u]) + before * float(lines.column_step[u])
    return bool(across < -BESIDE or across >= columns - 1 + BESIDE)
