"""Where a low step ends a line: what lies beyond one up is not told, and one down is an edge."""

from __future__ import annotations

import numpy as np
from numba import njit

from cliffscan.common.perception.floor_points import Metres
from cliffscan.common.perception.low_steps import FALL, Sight, low_steps, rows_near
from cliffscan.services.negative.beam_lines import BeamLines, Rows
from cliffscan.services.negative.floor_following import End

DROP, OCCLUDED = np.float32(End.DROP), np.float32(End.OCCLUDED)
Traced = tuple[Metres, Metres, Metres, Metres, Metres]


def end_at_steps(traced: Traced, heights: Metres, order: Rows, lines: BeamLines, sight: Sight) -> None:
    """Let lines end, in place, at the low steps that they cross before.

    traced: as floor_trace has it; heights, order, lines: as heights_along has them.
    """
    middle = len(lines.fall) // 2
    falls = lines.fall[middle] + order * lines.fall_step[middle]
    near = rows_near(falls / (lines.ahead[middle] + order * lines.ahead_step[middle]), 1, sight)
    distances = distances_along(heights, order[: near[-1] + 1] if len(near) else order[:0], lines, sight.camera_height)
    steps = low_steps(heights, distances, near, sight)
    some = np.flatnonzero(steps.kind)
    end, floor_row, level, sure_row, sure_level = traced
    outward = 1.0 if order[-1] > order[0] else -1.0
    rows = order[steps.before[some].astype(np.int64)].astype(np.float32)
    nearer = (floor_row[some] - rows) * outward > 0.0
    some, rows = some[nearer], rows[nearer]
    end[some] = np.where(steps.kind[some] == FALL, DROP, OCCLUDED)
    floor_row[some], level[some] = rows, steps.level[some]
    surer = (sure_row[some] - rows) * outward > 0.0
    some, rows = some[surer], rows[surer]
    sure_row[some], sure_level[some] = rows, steps.level[some]


@njit(cache=True, error_model="numpy")
def distances_along(heights: Metres, order: Rows, lines: BeamLines, camera_height: np.float32) -> Metres:
    """How far away [m] along the floor the points at some heights are, in the rows of `order`: (rows, lines)."""
    distances = np.empty((len(order), heights.shape[1]), np.float32)
    for index in range(len(order)):
        at = np.float32(order[index])
        for u in range(heights.shape[1]):
            ahead = lines.ahead[u] + at * lines.ahead_step[u]
            fall = lines.fall[u] + at * lines.fall_step[u]
            distances[index, u] = ahead * (camera_height - heights[index, u]) / fall
    return distances
