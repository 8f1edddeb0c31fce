"""A depth image as points seen from the floor, and which of them each beam sees: what the kernels work on.

A pixel's azimuth does not depend on its depth, and all pixels of one azimuth lie on a straight line of the image:
the trace of the vertical plane through the camera. So a beam is the strip between two such lines, and the pixels of
a row that it sees are a run of columns. A strip that falls between two pixel centres of a row takes the column that
covers the beam's middle.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from common.geometry import Affine, Camera, Floats, scan_axes
from common.grid import Grid

Columns = NDArray[np.int32]
Metres = NDArray[np.float32]

MILLIMETRE = 0.001
ABREAST = np.pi / 2 - 1e-6  # [rad] no ray that leads forward has an azimuth beyond


class Points(NamedTuple):
    """What a depth image tells of the floor; pixels without a usable return have height NaN."""

    heights: Metres  # (rows, columns) [m] above the floor plane
    distances: Metres  # (rows, columns) [m] along the floor, from the point below the camera
    first: Columns  # (rows, beams): the first column that a beam sees in a row,
    end: Columns  # (rows, beams): and the one after its last


class _View(NamedTuple):
    """All of a camera's points that does not depend on the depths."""

    transposed: bool
    up: Floats  # (rows, columns) [m] of height gained per millimetre of depth
    along: Floats  # (rows, columns) [m] of distance gained per millimetre of depth; NaN where a ray leads backward
    first: Columns
    end: Columns


def points_of(depth: NDArray[np.uint16], camera: Camera, grid: Grid, range_min: float = 0.0) -> Points:
    """The points of `depth` (rows, columns) [mm] and the pixels that each beam of `grid` sees.

    Depths outside the sensor's range and points nearer than range_min [m], parts of the robot, are left out.
    A camera on its side is looked at transposed, so that beams always run nearer to the columns than to the rows.
    """
    view = _view_of(camera, grid)
    millimetres = np.ascontiguousarray(depth.T if view.transposed else depth)
    near, far = (round(limit / MILLIMETRE) for limit in camera.range)
    measured = _measure(millimetres, view.up, view.along, camera.floor.d, max(near, 1), far, range_min)
    return Points(*measured, view.first, view.end)


@njit(cache=True)
def _measure(
    millimetres: NDArray[np.uint16],
    up: Floats,
    along: Floats,
    camera_height: float,
    near: int,
    far: int,
    range_min: float,
) -> tuple[Metres, Metres]:
    """Heights and distances of all pixels, in one pass over the image."""
    heights, distances = np.empty(up.shape, np.float32), np.empty(up.shape, np.float32)
    for row in range(up.shape[0]):
        for column in range(up.shape[1]):
            depth = millimetres[row, column]
            distance = along[row, column] * depth
            usable = near <= depth <= far and distance >= range_min
            heights[row, column] = up[row, column] * depth + camera_height if usable else np.nan
            distances[row, column] = distance
    return heights, distances


@lru_cache(maxsize=4)
def _view_of(camera: Camera, grid: Grid) -> _View:
    _, left, _ = axes = scan_axes(camera)
    transposed = abs(left.rows[1] - left.rows[0]) > abs(left.columns[1] - left.columns[0])
    forward, left, up = (Affine(axis.rows, axis.columns) if transposed else axis for axis in axes)
    ahead = forward.table()
    along = np.where(ahead > 0.0, np.hypot(ahead, left.table()), np.nan)
    return _View(transposed, up.table() * MILLIMETRE, along * MILLIMETRE, *_columns(forward, left, grid))


def _columns(forward: Affine, left: Affine, grid: Grid) -> tuple[Columns, Columns]:
    """The run of columns, first and one after the last, that each beam sees in each row: two of (rows, beams)."""
    edges = _lines(forward, left, np.clip(grid.edges(), -ABREAST, ABREAST))
    one, other = edges[:, :-1], edges[:, 1:]
    first, end = np.ceil(np.minimum(one, other)), np.ceil(np.maximum(one, other))
    covering = np.floor(_lines(forward, left, grid.angles()) + 0.5)
    narrow = first >= end

    def whole(columns: Floats) -> Columns:
        return np.nan_to_num(np.clip(columns, 0, forward.columns.size)).astype(np.int32)

    return whole(np.where(narrow, covering, first)), whole(np.where(narrow, covering + 1, end))


def _lines(forward: Affine, left: Affine, azimuths: Floats) -> Floats:
    """The column at which a line of constant azimuth crosses each row, for each azimuth [rad]: (rows, azimuths).

    Seen from above, a ray has azimuth a where left·cos a - forward·sin a is 0, which is affine in (u, v).
    """
    cos, sin = np.cos(azimuths), np.sin(azimuths)
    growth = (left.columns[1] - left.columns[0]) * cos - (forward.columns[1] - forward.columns[0]) * sin
    start = left.columns[0] * cos - forward.columns[0] * sin
    columns: Floats = -(start + left.rows[:, None] * cos - forward.rows[:, None] * sin) / growth
    return columns
