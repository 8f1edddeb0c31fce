"""Shadow: where a sensor with two eyes, or an eye and a projector, has no data beside something near."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine
from cliffscan.common.perception.point_heights import Metres

SLACK = 2.0  # columns by which its border is uncertain
BESIDE = 3  # columns next to the trace that its border may cross between two rows
STANDING = 0.03  # [m] above the floor, from which on something stands there
SEEN = 0.3  # share of floor returns between an obstacle and the trace that is too much for a shadow


@njit(cache=True, error_model="numpy")
def shadowed(
    heights: Metres,
    rates: Affine,
    camera_height: np.float32,
    columns: NDArray[np.int64],
    rows: NDArray[np.int64],
    outward: int,
    disparity: float,
    near: float,
) -> NDArray[np.bool_]:
    """Whether a shadow explains that a column's floor, last seen at that row, is lost beyond: (n,) for n columns.

    The sensor's two eyes are disparity [m px] apart: something z [m] away hides the floor at z' from one of them over
    disparity (1/z - 1/z') columns; nothing is nearer than near [m]. Nothing else lies between it and the trace, in the
    row before the floor was lost as well. The arrays are those of floor_trace; outward: 1 or -1, the step to the next
    row.
    """
    explained = np.zeros(len(columns), np.bool_)
    widest = int(disparity / near + SLACK) + 1
    for index in range(len(columns)):
        column, last = columns[index], rows[index]
        row = last + 2 * outward
        if row < 0 or row >= heights.shape[0]:
            continue
        floor = (rates.columns[column] + rates.rows[row]) / camera_height
        for side in (-1, 1):
            beside = column + side
            end = min(max(beside + side * widest, -1), heights.shape[1])
            while beside != end and np.isnan(heights[row, beside]):
                beside += side
            if beside == end or heights[row, beside] < STANDING:
                continue
            depth = (camera_height - heights[row, beside]) / (rates.columns[beside] + rates.rows[row])
            if abs(beside - column) > disparity * (1.0 / depth - floor) + SLACK:
                continue
            returns = 0
            for between in range(beside + side * -1, column + side * BESIDE, -side):
                returns += not np.isnan(heights[last, between])
            if returns <= SEEN * max(abs(beside - column) - BESIDE, 0):
                explained[index] = True
    return explained
