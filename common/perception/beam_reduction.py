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
from cliffscan.common.perception.image_region import View

Indices = NDArray[np.int32]

ABREAST = np.pi / 2 - 1e-6  # [rad] no ray that leads forward has an azimuth beyond
NOTHING = np.float32(np.inf)  # what a pixel says that tells nothing
LOOKED = np.float32(1e30)  # and one that tells that nothing is there


class Sight(NamedTuple):
    """Stretches of rows, and the beams that get a column's least value at a stretch's end.

    Stretch s has the rows starts[s] to starts[s + 1], and gives[s] to gives[s + 1] are the rows of `given` (n, 3) that
    belong to its end: a column, the first beam that sees it, and the one after the last.
    """

    starts: Indices
    gives: Indices
    given: Indices
    beams: int


@lru_cache(maxsize=8)
def sight_of(view: View, grid: Grid) -> Sight:
    """What the beams of `grid` see of a view."""
    edges = _lines(view, np.clip(grid.edges(), -ABREAST, ABREAST))
    return Sight(*_stretches(*edges, *_lines(view, grid.angles()), *view.shape), grid.beams)


def _lines(view: View, azimuths: Floats) -> tuple[Floats, Floats]:
    """The column at which a line of constant azimuth [rad] crosses row 0, and how much it moves with each row.

    Seen from above, a ray has azimuth a where left·cos a - forward·sin a is 0, which is affine in (u, v).
    """
    cos, sin = np.cos(azimuths), np.sin(azimuths)
    left, forward = view.left, view.forward
    growth = (left.columns[1] - left.columns[0]) * cos - (forward.columns[1] - forward.columns[0]) * sin
    start = (left.columns[0] + left.rows[0]) * cos - (forward.columns[0] + forward.rows[0]) * sin
    slope = (left.rows[1] - left.rows[0]) * cos - (forward.rows[1] - forward.rows[0]) * sin
    return -start / growth, -slope / growth


@njit(cache=True, error_model="numpy")
def _stretches(
    edges: Floats, edge_moves: Floats, middles: Floats, middle_moves: Floats, rows: int, columns: int
) -> tuple[Indices, Indices, Indices]:
    """The stretches of a Sight, row by row; a beam is looked at again only where one of its lines reaches a column."""
    beams = len(middles)
    starts, gives = np.zeros(rows + 1, np.int32), np.zeros(rows + 1, np.int32)
    given = np.empty((rows * columns + columns, 3), np.int32)
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
                given[count, 0], given[count, 1], given[count, 2] = column, seen_from[column], seen_to[column]
                count += 1
            seen_from[column], seen_to[column] = now_from[column], now_to[column]
        if row == 0 or count > before:
            starts[stretches], gives[stretches] = row, count
            stretches += 1
    for column in range(columns):
        given[count, 0], given[count, 1], given[count, 2] = column, seen_from[column], seen_to[column]
        count += 1
    starts[stretches], gives[stretches] = rows, count
    return starts[: stretches + 1].copy(), gives[: stretches + 1].copy(), given[:count].copy()


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


def least(values: Ranges, sight: Sight) -> Ranges:
    """The least that the pixels of each beam say: (beams,); NaN where none says anything, +inf where they only LOOKED.

    values: (stretches, columns), the least of each column's pixels in each stretch of rows; NOTHING and LOOKED count.
    """
    told = give(values, sight.gives, sight.given, sight.beams)
    told[told == NOTHING] = np.nan
    told[told == LOOKED] = np.inf
    return told


@njit(cache=True)
def give(values: Ranges, gives: Indices, given: Indices, beams: int) -> Ranges:
    """The least value of each beam: (beams,)."""
    told, carried = np.full(beams, NOTHING), np.full(values.shape[1], NOTHING)
    for stretch in range(values.shape[0]):
        for column in range(values.shape[1]):
            value = values[stretch, column]
            carried[column] = value if value < carried[column] else carried[column]
        for index in range(gives[stretch], gives[stretch + 1]):
            column = given[index, 0]
            for beam in range(given[index, 1], given[index, 2]):
                told[beam] = min(told[beam], carried[column])
            carried[column] = NOTHING
    return told
