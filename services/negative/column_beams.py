"""From the image's columns to the beams: what a column found is at a pixel, and that has an azimuth."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Floats


def beams_of_columns(
    azimuths: Floats,
    widths: Floats,
    ranges: Floats,
    evidence: Floats,
    clear: Floats,
    doubted: Floats,
    grid: Grid,
) -> Beams:
    """What the beams tell, of columns (columns,) that found ranges [m] at azimuths [rad], and floor up to clear [m].

    A beam listens to the columns whose middle it covers or that are less than their own width [rad] away; where there
    are none, to the nearest of the two that it lies between. It tells what is worst: the nearest number, or NaN, or
    +inf; what one of them does not know the other does not make free, nor is a beam between two that are not. A column
    leads over several azimuths if the camera is pitched; what it found doubtful holds from where it was sure last,
    at `doubted` [rad].
    """
    nearest, why, free = _tell(
        azimuths, widths, ranges, evidence, clear, doubted, grid.beams, grid.angle_min, grid.increment
    )
    return Beams(ranges=nearest, intensities=why, clear=free)


@njit(cache=True)
def _tell(
    azimuths: Floats,
    widths: Floats,
    ranges: Floats,
    evidence: Floats,
    clear: Floats,
    doubted: Floats,
    beams: int,
    angle_min: float,
    increment: float,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    told, why = np.full(beams, np.float32(np.nan)), np.zeros(beams, np.float32)
    free = np.zeros(beams, np.float32)
    heard = np.zeros(beams, np.int64)  # in which round
    last = len(azimuths) - 1
    for turn in (1, 2):
        for column in range(last + 1):
            at, value = azimuths[column], ranges[column]
            if turn == 1:
                reach = max(widths[column], 0.5 * increment)
                low, high = at - reach, at + reach
            else:
                before, after = azimuths[max(column - 1, 0)], azimuths[min(column + 1, last)]
                low, high = at + 0.5 * min(before - at, after - at, 0.0), at + 0.5 * max(before - at, after - at, 0.0)
            for beam in _between(low, high, beams, angle_min, increment):
                if heard[beam] and heard[beam] < turn:
                    continue
                if not heard[beam]:
                    worse = True
                elif np.isfinite(value):
                    worse = not value >= told[beam]
                else:
                    worse = np.isnan(value) and np.isinf(told[beam])
                if worse:
                    told[beam], why[beam] = value, evidence[column]
                free[beam] = min(free[beam], clear[column]) if heard[beam] else clear[column]
                heard[beam] = turn
    for column in range(last):
        if not np.isinf(ranges[column]) and not np.isinf(ranges[column + 1]):
            for beam in _between(azimuths[column], azimuths[column + 1], beams, angle_min, increment):
                told[beam] = np.nan if np.isinf(told[beam]) else told[beam]
                free[beam] = min(free[beam], clear[column], clear[column + 1])
    for column in range(last + 1):
        if doubted[column] != azimuths[column]:
            reach = max(widths[column], 0.5 * increment)
            low, high = min(azimuths[column], doubted[column]), max(azimuths[column], doubted[column])
            for beam in _between(low - reach, high + reach, beams, angle_min, increment):
                free[beam] = min(free[beam], clear[column])
    return told, why, free


@njit(cache=True)
def _between(one: float, other: float, beams: int, angle_min: float, increment: float) -> range:
    """The beams from one azimuth [rad] to another."""
    low, high = min(one, other), max(one, other)
    first, last = np.ceil((low - angle_min) / increment), np.floor((high - angle_min) / increment)
    return range(max(int(first), 0), min(int(last), beams - 1) + 1)
