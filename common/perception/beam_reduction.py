"""Which pixels each beam sees, and the least of what they say.

A pixel's azimuth does not depend on its depth, and all pixels of one azimuth lie on a straight line of the image:
the trace of the vertical plane through the camera. So a beam is the strip between two such lines, and the pixels of
a row that it sees are a run of columns. A strip that falls between two pixel centres of a row takes the column that
covers the beam's middle.

Seen the other way, a column of a row is seen by a run of beams, and for many rows by the same: of a level camera by
the same in all rows. So the least value of a column is carried from row to row, and is given to its beams only where
they change.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Floats
from cliffscan.common.perception.image_region import ImageRegion

Indices = NDArray[np.int32]

ABREAST = np.pi / 2 - 1e-6  # [rad] no ray that leads forward has an azimuth beyond
NOTHING = np.float32(np.inf)  # what a pixel says that tells nothing
LOOKED = np.float32(1e30)  # and one that tells that nothing is there


class BeamReduction(NamedTuple):
    """Stretches of rows, and the beams that get a column's least value at a stretch's end.

    Stretch s has the rows starts[s] to starts[s + 1]. Rows ends[s] to ends[s + 1] of handed_over (n, 3) belong to its
    end: a column, the first beam that sees it, and the one after the last.
    """

    starts: Indices
    ends: Indices
    handed_over: Indices
    beams: int


@lru_cache(maxsize=8)
def beam_reduction(region: ImageRegion, grid: Grid) -> BeamReduction:
    """What the beams of `grid` see of a region."""
    between = np.clip(grid.edges(), -ABREAST, ABREAST)  # equation (2) rounds to the beam between two
    edges = azimuth_lines(region, between)
    return BeamReduction(*_stretches(*edges, *azimuth_lines(region, grid.angles()), *region.shape), grid.beams)


def azimuth_lines(region: ImageRegion, azimuths: Floats) -> tuple[Floats, Floats]:
    """The column at which a line of constant azimuth [rad] crosses row 0, and how much it moves with each row.

    Seen from above, a ray has azimuth a, equation (1), where left·cos a - forward·sin a is 0: affine in (u, v).
    """
    cos, sin = np.cos(azimuths), np.sin(azimuths)
    left, forward = region.left, region.forward
    growth = (left.columns[1] - left.columns[0]) * cos - (forward.columns[1] - forward.columns[0]) * sin
    start = (left.columns[0] + left.rows[0]) * cos - (forward.columns[0] + forward.rows[0]) * sin
    slope = (left.rows[1] - left.rows[0]) * cos - (forward.rows[1] - forward.rows[0]) * sin
    return -start / growth, -slope / growth


@njit(cache=True, error_model="numpy")
def _stretches(
    edges: Floats, edge_moves: Floats, middles: Floats, middle_moves: Floats, rows: int, columns: int
) -> tuple[Indices, Indices, Indices]:
    """The stretches, row by row; a beam is looked at again only where one of its lines reaches a column."""
    beams = len(middles)
    starts, ends = np.zeros(rows + 1, np.int32), np.zeros(rows + 1, np.int32)
    handed_over = np.empty((rows * columns + columns, 3), np.int32)
    first, last, due = np.zeros(beams, np.int64), np.full(beams, -1, np.int64), np.zeros(beams, np.int64)
    seen_from, seen_to = np.zeros(columns, np.int64), np.zeros(columns, np.int64)
    now_from, now_to = np.zeros(columns, np.int64), np.zeros(columns, np.int64)
    touched, touched_at, moved = np.empty(columns, np.int64), np.full(columns, -1, np.int64), np.empty(beams, np.int64)
    stretches, count = 0, 0
    for row in range(rows):
        touches, moves = 0, 0
        for beam in range(beams):
            if due[beam] > row:
                continue
            one, other = edges[beam] + row * edge_moves[beam], edges[beam + 1] + row * edge_moves[beam + 1]
            middle = middles[beam] + row * middle_moves[beam] + 0.5
            a, b = _run(min(one, other), max(one, other), middle, columns)
            wait = min(_rows_until(one, edge_moves[beam]), _rows_until(other, edge_moves[beam + 1]))
            due[beam] = row + max(int(min(wait, _rows_until(middle, middle_moves[beam]), rows)), 1)
            if a == first[beam] and b == last[beam]:
                continue
            for column in list(range(first[beam], last[beam] + 1)) + list(range(a, b + 1)):
                if touched_at[column] < row:
                    touched[touches], touched_at[column] = column, row
                    touches += 1
            first[beam], last[beam], moved[moves] = a, b, beam
            moves += 1
        for column in touched[:touches]:  # of the beams that saw it, those that still do
            now_from[column], now_to[column] = beams, 0
            for beam in range(seen_from[column], seen_to[column]):
                if first[beam] <= column <= last[beam]:
                    now_from[column], now_to[column] = min(now_from[column], beam), beam + 1
        for beam in moved[:moves]:  # and those that see it now
            for column in range(first[beam], last[beam] + 1):
                now_from[column], now_to[column] = min(now_from[column], beam), max(now_to[column], beam + 1)
        before = count
        for column in touched[:touches]:
            if row and (now_from[column] != seen_from[column] or now_to[column] != seen_to[column]):
                handed_over[count, 0], handed_over[count, 1], handed_over[count, 2] = (
                    column,
                    seen_from[column],
                    seen_to[column],
                )
                count += 1
            seen_from[column], seen_to[column] = now_from[column], now_to[column]
        if row == 0 or count > before:
            starts[stretches], ends[stretches] = row, count
            stretches += 1
    for column in range(columns):
        handed_over[count, 0] = column
        handed_over[count, 1], handed_over[count, 2] = seen_from[column], seen_to[column]
        count += 1
    starts[stretches], ends[stretches] = rows, count
    return starts[: stretches + 1].copy(), ends[: stretches + 1].copy(), handed_over[:count].copy()


@njit(cache=True, error_model="numpy")
def _run(low: float, high: float, middle: float, columns: int) -> tuple[int, int]:
    """First and last column between two lines, or else the one that covers the middle; 0 and -1 = none of the image."""
    low, high = np.ceil(low), np.ceil(high) - 1.0
    if not low <= high:
        low = high = np.floor(middle)
    if not (high >= 0.0 and low < columns):
        return 0, -1
    return int(max(low, 0.0)), int(min(high, columns - 1.0))


@njit(cache=True, error_model="numpy")
def _rows_until(at: float, move: float) -> float:
    """How many rows on, at least, a line stays between the same two whole columns; NaN or infinite where it is none."""
    way = np.floor(at) + 1.0 - at if move > 0.0 else at - np.ceil(at) + 1.0
    rows: float = way / abs(move) - 1.0
    return rows


def min_per_beam(values: Ranges, reduction: BeamReduction) -> Ranges:
    """The least that the pixels of each beam say: (beams,); NaN where none says anything, +inf where they only LOOKED.

    values: (stretches, columns), the least of each column's pixels in each stretch of rows; NOTHING and LOOKED count.
    """
    told = _min_per_beam(values, reduction.ends, reduction.handed_over, reduction.beams)
    told[told == NOTHING] = np.nan
    told[told == LOOKED] = np.inf
    return told


@njit(cache=True)
def _min_per_beam(values: Ranges, ends: Indices, handed_over: Indices, beams: int) -> Ranges:
    """The least value of each beam: (beams,)."""
    told, carried = np.full(beams, NOTHING), np.full(values.shape[1], NOTHING)
    for stretch in range(values.shape[0]):
        for column in range(values.shape[1]):
            value = values[stretch, column]
            carried[column] = value if value < carried[column] else carried[column]
        for index in range(ends[stretch], ends[stretch + 1]):
            column = handed_over[index, 0]
            for beam in range(handed_over[index, 1], handed_over[index, 2]):
                told[beam] = min(told[beam], carried[column])
            carried[column] = NOTHING
    return told
