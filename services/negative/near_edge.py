"""Near edge: the floor is followed outward from the robot, and ends where the last of it was seen.

Each column of the image is followed over the floor; where the floor stops, by a drop or by data lost over more than the
sensor's row spacing and noise explain, the last floor seen is the edge.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.image_region import View
from cliffscan.common.perception.point_heights import Points
from cliffscan.services.negative.column_beams import beams_of_columns
from cliffscan.services.negative.column_edges import locate_edges, reject_unreliable
from cliffscan.services.negative.floor_following import End, FloorCriteria, floor_trace, single
from cliffscan.services.negative.shadow import shadowed

FloorLost = Literal["counts", "beside_drop", "ignored"]

APART = 0.01  # [m] of floor between two rows that are looked at, where the image has more


def near_edge(
    points: Points, grid: Grid, criteria: FloorCriteria[float], floor_lost: FloorLost, baseline: float
) -> Beams:
    """Range [m] of the last floor before a drop in each beam, on what it rests, how far floor is clear: (beams,) each.

    +inf where floor was seen as far as the sensor sees it; NaN where it was not: behind an obstacle, in its shadow,
    beyond a gap. An edge can be told no better than the spacing of the rows on the floor, z²/(f·h).
    floor_lost: whether floor that is lost counts as a drop, only beside a drop that is seen, or not at all;
    baseline [m]: between the sensor's two eyes, or its eye and its projector.
    """
    view = points.view
    rates = view.up.single(-1.0)
    height = np.float32(view.camera.floor.d)
    order = rows_outward(view, criteria)
    if not len(order):
        nothing = np.zeros(grid.beams, np.float32)
        return Beams(ranges=np.full(grid.beams, np.nan, np.float32), intensities=nothing, clear=nothing)
    end, row, level, sure, sure_level = floor_trace(points.heights, order, rates, height, single(criteria))
    if not view.transposed:  # a camera on its side has its eyes one above the other
        lost = np.flatnonzero(end == End.NO_RETURN)
        outward = 1 if view.up.rows[1] > view.up.rows[0] else -1
        disparity = baseline * view.camera.intrinsics.fx
        rows = row[lost].astype(np.int64)
        hidden = shadowed(points.heights, rates, height, lost, rows, outward, disparity, criteria.near)
        end[lost[hidden]] = End.OCCLUDED
    azimuths, widths, ranges, clear, doubted = locate_edges(
        end, row, level, sure, sure_level, view.forward, view.left, view.up, view.camera.floor.d
    )
    reject_unreliable(end, ranges, widths, floor_lost == "counts", floor_lost != "ignored")
    meaning = end.astype(np.int8)
    ranges = np.where(EVIDENCE[meaning] > 0.0, ranges, WITHOUT_NUMBER[meaning])
    return beams_of_columns(azimuths, widths, ranges, EVIDENCE[meaning], clear, doubted, grid)


EVIDENCE = np.zeros(len(End))  # of each End; 0: it makes no number
EVIDENCE[End.DROP], EVIDENCE[End.NO_RETURN] = Evidence.DROP, Evidence.FLOOR_LOST
WITHOUT_NUMBER = np.full(len(End), np.nan)  # what the others make
WITHOUT_NUMBER[End.REACHED_RANGE] = np.inf


@lru_cache(maxsize=4)
def rows_outward(view: View, criteria: FloorCriteria[float]) -> NDArray[np.int32]:
    """The rows of a view that see floor within the criteria, near to far, each at least APART beyond the one before."""
    rows = np.arange(view.shape[0])
    if view.up.rows[0] > view.up.rows[1]:
        rows = rows[::-1]
    rate = -(view.up.rows[rows, None] + view.up.columns[None, [0, len(view.up.columns) // 2, -1]])
    inverse = rate / view.camera.floor.d
    floor = np.any((inverse > 0.5 / criteria.far) & (rate > 0.0), axis=1)
    steps = np.floor(1.0 / (APART * np.maximum(inverse, 0.5 / criteria.far)))
    moved = np.any(np.diff(steps, axis=0, prepend=-1.0) != 0.0, axis=1)
    chosen: NDArray[np.int32] = rows[floor & moved].astype(np.int32)
    return chosen
