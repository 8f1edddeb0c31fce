"""What the traces of the columns come to: where each ended, and which ends are to be believed."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from cliffscan.common.contract.camera import Affine, Floats
from cliffscan.common.perception.point_heights import Metres
from cliffscan.services.negative.floor_following import End

DROP, NO_RETURN, UNVERIFIED = np.float32(End.DROP), np.float32(End.NO_RETURN), np.float32(End.UNVERIFIED)
SIDE = 4  # columns to either side whose floor levels a column's is averaged with,
AGREE = 0.01  # [m] if they agree so well: noise in the level is noise in the edge
NARROWEST = 0.03  # [m] what fewer columns side by side saw is noise


@njit(cache=True, error_model="numpy")
def locate_edges(
    end: Metres,
    row: Metres,
    level: Metres,
    sure: Metres,
    sure_level: Metres,
    forward: Affine,
    left: Affine,
    up: Affine,
    camera_height: float,
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Azimuth and width [rad] of each column and range [m] where its floor ends; range and azimuth where it was sure.

    (columns,) each; floor is sure up to 0 m where there is no such row.
    end, row, level, sure, sure_level: as floor_trace has them; forward, left, up: of the view.
    """
    columns = len(end)
    azimuths, widths, ranges = np.empty(columns), np.empty(columns), np.empty(columns)
    clear, doubted = np.zeros(columns), np.empty(columns)
    more_ahead = forward.columns[1] - forward.columns[0]
    more_aside = left.columns[1] - left.columns[0]
    for u in range(columns):
        height = float(level[u])
        if (end[u] == DROP or end[u] == NO_RETURN) and row[u] >= 0:
            total, many = 0.0, 0
            for other in range(max(u - SIDE, 0), min(u + SIDE + 1, columns)):
                alike = (end[other] == DROP or end[other] == NO_RETURN) and row[other] >= 0
                total += level[other] if alike else 0.0
                many += alike
            height = total / many if abs(total / many - level[u]) < AGREE else height
        v = max(int(row[u]), 0)
        ahead, aside = forward.columns[u] + forward.rows[v], left.columns[u] + left.rows[v]
        azimuths[u] = math.atan2(aside, ahead)
        widths[u] = abs(more_aside * ahead - more_ahead * aside) / (ahead * ahead + aside * aside)
        ranges[u] = math.hypot(ahead, aside) * (height - camera_height) / (up.columns[u] + up.rows[v])
        doubted[u] = azimuths[u]
        if sure[u] >= 0 and sure[u] == row[u]:
            clear[u] = ranges[u]
        elif sure[u] >= 0:
            v = int(sure[u])
            ahead, aside = forward.columns[u] + forward.rows[v], left.columns[u] + left.rows[v]
            doubted[u] = math.atan2(aside, ahead)
            clear[u] = math.hypot(ahead, aside) * (sure_level[u] - camera_height) / (up.columns[u] + up.rows[v])
    return azimuths, widths, ranges, clear, doubted


@njit(cache=True)
def reject_unreliable(end: Metres, ranges: Floats, widths: Floats, alone: bool, lost_counts: bool) -> None:
    """Make UNVERIFIED, in place, what too few columns side by side saw, and floor lost that is not to count.

    ranges [m] and widths [rad] of the columns: (columns,) each; lost_counts: whether floor lost counts, and alone:
    whether it does without a drop that is seen beside it.
    """
    first, columns = 0, len(end)
    while first < columns:
        stop, across, drop = first, 0.0, False
        while stop < columns and (end[stop] == DROP or end[stop] == NO_RETURN):
            across, drop = across + widths[stop] * ranges[stop], drop or end[stop] == DROP
            stop += 1
        within = first > 0 and stop < columns
        narrow = within and across < NARROWEST
        ignored = not lost_counts or not (alone or drop)
        for u in range(first, stop):
            if narrow or (ignored and end[u] == NO_RETURN):
                end[u] = UNVERIFIED
        first = stop + 1
