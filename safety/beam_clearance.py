"""How far a scan looks past a cell of the ground: the geometry of beams, without a memory."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Cells = NDArray[np.int64]


def seen_past(distances: Floats, azimuths: Floats, half: float, free: Floats, angles: Floats) -> Floats:
    """How far [m] all beams that cross a cell show floor; 0 where a beam that could cross it is missing.

    distances (n,) [m] and azimuths (n,) [rad] of the cells' middles from the scanner; half [m], from a middle to a
    corner. free (beams,) [m] is how far each beam shows floor, at evenly spaced angles [rad].
    """
    return _least_between(free, *_crossing(distances, azimuths, half, angles))


def _crossing(distances: Floats, azimuths: Floats, half: float, angles: Floats) -> tuple[Cells, Cells]:
    """First and last beam that touch each cell; beyond the scan's sides first is after last."""
    increment = angles[1] - angles[0]
    middle = (azimuths - angles[0]) / increment + 0.5
    aside = np.arcsin(np.minimum(half / distances, 1.0)) / increment
    first, last = np.floor(middle - aside).astype(np.int64), np.floor(middle + aside).astype(np.int64)
    inside = (first >= 0) & (last < len(angles))
    return np.where(inside, first, 0), np.where(inside, last, -1)


def _least_between(values: Floats, first: Cells, last: Cells) -> Floats:
    """The least of values[first ... last] for each pair; 0 where there is none.

    Row k of a table holds the least of each 2**k values in a row; two of them cover any range.
    """
    size = np.maximum(last - first + 1, 1)
    level = np.frexp(size)[1] - 1  # the greatest power of two in it
    table = np.zeros((int(level.max()) + 1, len(values)))
    table[0] = values
    for step in range(1, len(table)):
        span, half = len(values) - 2**step + 1, 2 ** (step - 1)
        np.minimum(table[step - 1, :span], table[step - 1, half : half + span], out=table[step, :span])
    least = np.minimum(table[level, first], table[level, np.maximum(last, 0) - (1 << level) + 1])
    return np.where(last >= first, least, 0.0)


def sector(reach: float, side: float) -> tuple[float, float]:
    """The circle around a sector of `reach` [m] and `side` [rad] to either side: middle ahead and radius, both [m]."""
    around = reach / (2.0 * math.cos(side))
    return (around, around) if around < reach else (0.0, reach)
