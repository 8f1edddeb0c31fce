"""From the image's columns to the beams: what a column found is at a pixel, and that has an azimuth."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from common.combine import Beams
from common.geometry import Floats
from common.grid import Grid


def beams_of_columns(azimuths: Floats, ranges: Floats, evidence: Floats, grid: Grid) -> Beams:
    """What the beams tell, of columns (columns,) that found ranges [m] at azimuths [rad], each on some evidence.

    A beam listens to the columns less than a column's width away, and tells what is worst: the nearest number, or NaN,
    or +inf; for what one of them does not know the other does not make free.
    """
    width = abs(azimuths[-1] - azimuths[0]) / (len(azimuths) - 1)
    told, why = _tell(azimuths, ranges, evidence, grid.beams, grid.angle_min, grid.increment, width)
    return Beams(told, why)


@njit(cache=True)
def _tell(
    azimuths: Floats, ranges: Floats, evidence: Floats, beams: int, angle_min: float, increment: float, width: float
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    told, why = np.full(beams, np.float32(np.nan)), np.zeros(beams, np.float32)
    heard = np.zeros(beams, np.bool_)
    for column in range(len(azimuths)):
        at, value = (azimuths[column] - angle_min) / increment, ranges[column]
        first, last = np.ceil(at - width / increment), np.floor(at + width / increment)
        for beam in range(max(int(first), 0), min(int(last), beams - 1) + 1):
            before = told[beam]
            if not heard[beam]:
                worse = True
            elif np.isfinite(value):
                worse = not value >= before
            else:
                worse = np.isnan(value) and np.isinf(before)
            if worse:
                told[beam], why[beam] = value, evidence[column]
            heard[beam] = True
    return told, why
