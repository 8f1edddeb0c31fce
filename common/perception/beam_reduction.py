"""Which pixels each beam sees, and the least of what they say.

A pixel's azimuth does not depend on its depth, and all pixels of one azimuth lie on a straight line of the image:
the trace of the vertical plane through the camera. So a beam is the strip between two such lines, and the pixels of
a row that it sees are a run of columns. A strip that falls between two pixel centres of a row takes the column that
covers the beam's middle.

The image is looked at in blocks of rows. A line moves one way only, so the columns that a beam sees in a block lie
between those of its first row and of the next block's. If they are the same, the beam takes the block's least value of
each. If not, that least is a bound, and only where it is less than what the beam has are the block's rows looked at.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Affine, Floats
from cliffscan.common.perception.image_region import ImageRegion

Indices = NDArray[np.int32]

ABREAST = np.pi / 2 - 1e-6  # [rad] no ray that leads forward has an azimuth beyond
NOTHING = np.float32(np.inf)  # what a pixel says that tells nothing
LOOKED = np.float32(1e30)  # and one that tells that nothing is there
ZERO = np.float32(0.0)
BLOCK = 32  # [rows] at least, of a block
HALF = 0.5  # [columns] from a pixel's centre to its end


class Lines(NamedTuple):
    """Lines of constant azimuth: the columns at which they cross row 0, and how much each row more adds; (lines,)."""

    columns: Floats
    moves: Floats


class Directions(NamedTuple):
    """Cosines and sines of azimuths."""

    cos: Floats
    sin: Floats


@lru_cache(maxsize=8)
def directions(grid: Grid) -> tuple[Directions, Directions]:
    """Of the bounds of a grid's beams, (beams + 1,), and of their middles, (beams,)."""
    bounds = np.clip(grid.edges(), -ABREAST, ABREAST)  # equation (2) rounds to the beam between two
    between, middles = (Directions(np.cos(each), np.sin(each)) for each in (bounds, grid.angles()))
    return between, middles


def azimuth_lines(region: ImageRegion, azimuths: Floats) -> Lines:
    """The lines of some azimuths [rad]."""
    return _lines(region.left, region.forward, Directions(np.cos(azimuths), np.sin(azimuths)))


def min_per_beam(values: Ranges, region: ImageRegion, grid: Grid) -> Ranges:
    """The least that the pixels of each beam say: (beams,); NaN where none says anything, +inf where they only LOOKED.

    values: (rows, columns) of the region; NOTHING and LOOKED count.
    """
    return _min_per_beam(values, region.left, region.forward, *directions(grid))


@njit(cache=True, error_model="numpy")
def _lines(left: Affine, forward: Affine, towards: Directions) -> Lines:
    """Seen from above, a ray has azimuth a, equation (1), where left·cos a - forward·sin a is 0: affine in (u, v)."""
    cos, sin = towards.cos, towards.sin
    growth = (left.columns[1] - left.columns[0]) * cos - (forward.columns[1] - forward.columns[0]) * sin
    start = (left.columns[0] + left.rows[0]) * cos - (forward.columns[0] + forward.rows[0]) * sin
    slope = (left.rows[1] - left.rows[0]) * cos - (forward.rows[1] - forward.rows[0]) * sin
    return Lines(-start / growth, -slope / growth)


@njit(cache=True, error_model="numpy")
def _min_per_beam(values: Ranges, left: Affine, forward: Affine, between: Directions, amid: Directions) -> Ranges:
    """Block by block of rows; between: the directions of the beams' bounds, amid: of their middles."""
    bounds, middles = _lines(left, forward, between), _lines(left, forward, amid)
    rows, columns = values.shape
    beams = len(amid.cos)
    told, least = np.full(beams, NOTHING), np.empty(columns, np.float32)
    entering, leaving = np.empty((2, beams + 1), np.int32), np.empty((2, beams + 1), np.int32)
    block = _rows_per_block(bounds.moves, rows)
    _cross(bounds, middles, 0, columns, entering)
    for start in range(0, rows, block):
        stop = min(start + block, rows)
        _least_of_rows(values, start, stop, least)
        _cross(bounds, middles, stop, columns, leaving)
        for beam in range(beams):
            a, b, middle = entering[0, beam], entering[0, beam + 1], entering[1, beam]
            c, d, end = leaving[0, beam], leaving[0, beam + 1], leaving[1, beam]
            first, last = min(a, b, c, d), max(a, b, c, d) - 1
            constant = (a == c) & (b == d) & ((a != b) | (middle == end))
            if first > last or not constant:
                first, last = min(first, middle, end), max(last, middle, end)
            bound = told[beam]
            for column in range(max(first, 0), min(last, columns - 1) + 1):
                bound = min(bound, least[column])
            if constant:
                told[beam] = bound
            elif bound < told[beam]:
                told[beam] = _least_in_block(values, start, stop, bounds, middles, beam, told[beam], bound)
        entering, leaving = leaving, entering
    for beam in range(beams):
        if told[beam] == NOTHING:
            told[beam] = np.nan
        elif told[beam] == LOOKED:
            told[beam] = np.inf
    return told


@njit(cache=True, error_model="numpy")
def _rows_per_block(moves: Floats, rows: int) -> int:
    """So many that no line moves by more than a column, but BLOCK at least: of a level camera all."""
    fastest = 0.0
    for move in moves:
        fastest = max(fastest, abs(move))
    return rows if fastest * rows < 1.0 else max(BLOCK, int(1.0 / fastest))


@njit(cache=True, error_model="numpy")
def _least_of_rows(values: Ranges, start: int, stop: int, least: Ranges) -> None:
    """The least value of each column in some rows, into `least`, (columns,)."""
    for column in range(len(least)):
        least[column] = values[start, column]
    for row in range(start + 1, stop):
        for column in range(len(least)):
            value, before = values[row, column], least[column]
            # without `+ ZERO` the compiler makes masked stores of it, which are slow on some processors
            least[column] = value if value < before else before + ZERO


@njit(cache=True, error_model="numpy")
def _cross(bounds: Lines, middles: Lines, row: int, columns: int, crossed: Indices) -> None:
    """Where lines cross a row, (2, beams + 1): the first whole columns at the bounds, the columns that cover middles.

    Those beyond the image are -1 or less, or columns + 1.
    """
    for line in range(len(bounds.columns)):
        at = np.ceil(bounds.columns[line] + row * bounds.moves[line])
        at = at if at > -1.0 else -1.0
        crossed[0, line] = np.int32(at if at < columns + 1.0 else columns + 1.0)
    for line in range(len(middles.columns)):
        at = np.floor(middles.columns[line] + row * middles.moves[line] + HALF)
        at = at if at > -2.0 else -2.0
        crossed[1, line] = np.int32(at if at < columns + 1.0 else columns + 1.0)


@njit(cache=True, error_model="numpy")
def _least_in_block(
    values: Ranges,
    start: int,
    stop: int,
    bounds: Lines,
    middles: Lines,
    beam: int,
    told: np.float32,
    bound: np.float32,
) -> np.float32:
    """The least of `told` and what a beam sees in some rows, where it sees nothing less than `bound`.

    The beam's run of columns is found anew only in the rows where one of its lines reaches a column.
    """
    row = start
    while row < stop and told > bound:
        one = bounds.columns[beam] + row * bounds.moves[beam]
        other = bounds.columns[beam + 1] + row * bounds.moves[beam + 1]
        middle = middles.columns[beam] + row * middles.moves[beam] + HALF
        first, last = _run(min(one, other), max(one, other), middle, values.shape[1])
        wait = min(_rows_until(one, bounds.moves[beam]), _rows_until(other, bounds.moves[beam + 1]))
        wait = min(wait, _rows_until(middle, middles.moves[beam]), stop - row)
        until = row + max(int(wait), 1)
        for seen in range(row, until):
            for column in range(first, last + 1):
                told = min(told, values[seen, column])
        row = until
    return told


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
