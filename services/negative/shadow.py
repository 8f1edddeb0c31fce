"""Shadow: where a sensor with two eyes, or an eye and a projector, has no data beside something near."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine
from cliffscan.common.perception.floor_points import METRES
from cliffscan.common.perception.image_region import Millimetres

Pixels = NDArray[np.int64]

SLACK = 2.0  # columns by which its border is uncertain
BESIDE = 3  # columns next to the trace that its border may cross between two rows
STANDING = 0.03  # [m] above the floor, from which on something stands there
SEEN = 0.3  # share of floor returns between an obstacle and the trace that is too much for a shadow


@njit(cache=True, error_model="numpy")
def shadowed(
    depth: Millimetres,
    near: int,
    far: int,
    up: Affine,
    camera_height: float,
    last: Pixels,
    beyond: Pixels,
    disparity: float,
) -> NDArray[np.bool_]:
    """Whether a shadow explains that floor, last seen at one pixel, is lost at another beyond: (n,).

    The sensor's two eyes are disparity [m px] apart along its image's rows: something z [m] away hides the floor at z'
    from one of them over disparity (1/z - 1/z') columns. Nothing else lies between it and the trace, in the row where
    floor was last seen as well.
    depth: (rows, columns) [mm] as the sensor sends it, near to far of it usable; up: of all its pixels; last, beyond:
    (n, 2), row and column of each.
    """
    rows, columns = depth.shape
    explained = np.zeros(len(last), np.bool_)
    widest = int(disparity / (METRES * near) + SLACK) + 1
    for index in range(len(last)):
        row, column = beyond[index]
        if not (0 <= row < rows and 0 <= column < columns):
            continue
        row_before, shift = last[index, 0], last[index, 1] - column
        floor = -(up.columns[column] + up.rows[row]) / camera_height
        for side in (-1, 1):
            beside = column + side
            end = min(max(beside + side * widest, -1), columns)
            while beside != end and not near <= depth[row, beside] <= far:
                beside += side
            if beside == end:
                continue
            metres = METRES * depth[row, beside]
            if metres * (up.columns[beside] + up.rows[row]) + camera_height < STANDING:
                continue
            if abs(beside - column) > disparity * (1.0 / metres - floor) + SLACK:
                continue
            returns = 0
            for between in range(beside - side, column + side * BESIDE, -side):
                at = between + shift
                returns += 0 <= at < columns and near <= depth[row_before, at] <= far
            if returns <= SEEN * max(abs(beside - column) - BESIDE, 0):
                explained[index] = True
    return explained
