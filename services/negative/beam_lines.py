"""Lines of constant azimuth in the image, and the floor's heights along them.

The vertical plane of a beam cuts the image in a straight line. The floor is followed along it, in one pixel of each row
of the image, from the robot outward. So a camera may lean and look down as it likes: each line is what a level camera
sees in a column.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Affine, Floats
from cliffscan.common.perception.beam_reduction import ABREAST, azimuth_lines
from cliffscan.common.perception.floor_points import METRES, FloorPoints, Metres
from cliffscan.common.perception.image_region import ImageRegion, Millimetres, Strides

Rows = NDArray[np.int32]

APART = 0.01  # [m] of floor between two rows that are looked at, where the image has more
MOST_LINES = 4  # for each column
BELOW = np.float32(0.03)  # [m] the floor, what is nearer than range_min is no part of the robot
ASLANT = 30.0  # [columns] per row, by which a line may lean at most
BESIDE = np.float32(1.0)  # [columns] beside the outermost ones' middles: half a pixel, and half a beam
NOWHERE = np.float32(-1.0)  # a row
ZERO, HALF = np.float32(0.0), np.float32(0.5)


class BeamLines(NamedTuple):
    """Each line's column in row 0 of the region and, per metre of depth, what its ray there does: (lines,) each.

    All are affine in the row: the second of a pair is what one row more adds. float32.
    """

    column: Metres
    column_step: Metres
    ahead: Metres  # how far the ray leads along the floor [m]
    ahead_step: Metres
    fall: Metres  # and down [m]
    fall_step: Metres


def lines_per_beam(region: ImageRegion, grid: Grid) -> int:
    """So many that none is wider than a pixel in the image's middle: a coarse grid's beam sees many columns.

    But no more than MOST_LINES for each column of the image, however long a lens the frame says it has.
    """
    fx, fy, _, _ = region.camera.intrinsics
    most = MOST_LINES * region.shape[1] / grid.beams
    return max(1, round(min(grid.increment * (fy if region.transposed else fx), most)))


def beam_lines(region: ImageRegion, grid: Grid, each: int) -> BeamLines:
    """`each` lines of every beam of `grid`, side by side."""
    azimuths, cos, sin = _directions(grid, each)
    with np.errstate(all="ignore"):  # a line that leans as rows do has no column in each
        column, step = azimuth_lines(region, azimuths)
        leads = (np.abs(azimuths) < ABREAST) & (np.abs(step) <= ASLANT) & (np.abs(column) < np.float64(1e6))
    column, step = np.where(leads, column, -2.0 * BESIDE), np.where(leads, step, 0.0)
    forward, left = _along(region.forward, column, step), _along(region.left, column, step)
    ahead, ahead_step = (f * cos + s * sin for f, s in zip(forward, left, strict=True))
    rise, rise_step = _along(region.up, column, step)
    lines = (column, step, ahead, ahead_step, -rise, -rise_step)
    return BeamLines(*(value.astype(np.float32) for value in lines))


@lru_cache(maxsize=8)
def _directions(grid: Grid, each: int) -> tuple[Floats, Floats, Floats]:
    """The azimuths [rad] of the lines, their cosines and their sines."""
    between = ((np.arange(each) + 0.5) / each - 0.5) * grid.increment
    azimuths = (grid.angles()[:, None] + between).ravel()
    return azimuths, np.cos(azimuths), np.sin(azimuths)


def _along(axis: Affine, column: Floats, step: Floats) -> tuple[Floats, Floats]:
    """An affine quantity along lines: its value in row 0, and what one row more adds."""
    per_column, per_row = axis.columns[1] - axis.columns[0], axis.rows[1] - axis.rows[0]
    return axis.columns[0] + axis.rows[0] + per_column * column, per_column * step + per_row


@njit(cache=True, error_model="numpy")
def range_in(lines: BeamLines, u: int, row: float, below: float) -> float:
    """Range [m] of what a line's ray meets in a row, `below` [m] the camera."""
    ahead = float(lines.ahead[u]) + row * float(lines.ahead_step[u])
    return ahead * below / (float(lines.fall[u]) + row * float(lines.fall_step[u]))


def rows_outward(region: ImageRegion, lines: BeamLines, far: float) -> Rows:
    """The rows of a region that see floor, near to far, each at least APART beyond the one before.

    How far is measured where a row sees it farthest; a row that sees it up to `far` [m] deep and beyond is looked at.
    """
    rows = np.arange(region.shape[0])
    if lines.fall_step[len(lines.fall_step) // 2] > 0.0:
        rows = rows[::-1]
    inverse = -(region.up.rows[rows, None] + region.up.columns[[0, -1]]) / region.camera.floor.d
    farthest, least = inverse.min(axis=1), 0.5 / far
    steps = np.floor(1.0 / (APART * np.maximum(farthest, least)))
    moved = np.diff(steps, prepend=-1.0) != 0.0
    chosen: Rows = rows[(inverse.max(axis=1) > least) & (moved | (farthest < least))].astype(np.int32)
    return chosen


class InView(NamedTuple):
    """Of each line the rows in which its floor is in the image and in the sensor's range; (lines,) each, -1 = none."""

    first: Metres  # nearest to the robot
    due: Metres  # by which floor must be seen: the first beyond what may be parts of the robot
    last: Metres


def heights_along(points: FloorPoints, lines: BeamLines, order: Rows) -> tuple[Metres, InView]:
    """Heights [m] above the plane along the lines in the rows of `order`, (rows, lines); NaN = no usable return.

    What is nearer than range_min may be a part of the robot, and is no return, unless it lies below the floor.
    """
    region = points.region
    return _heights_along(
        points.depth.ravel(),
        region.strides,
        region.shape[1],
        region.up.single(),
        np.float32(region.camera.floor.d),
        np.float32(region.camera.range[0]),
        *points.usable,
        np.float32(points.range_min),
        lines,
        order,
    )


@njit(cache=True, error_model="numpy")
def _heights_along(
    millimetres: Millimetres,
    strides: Strides,
    columns: int,
    up: Affine,
    camera_height: np.float32,
    nearest: np.float32,
    near: np.uint16,
    far: np.uint16,
    range_min: np.float32,
    lines: BeamLines,
    order: Rows,
) -> tuple[Metres, InView]:
    many = len(lines.column)
    heights = np.empty((len(order), many), np.float32)
    first, due, last = np.full(many, NOWHERE), np.full(many, NOWHERE), np.full(many, NOWHERE)
    pixels, reach, depths = np.empty(many, np.int32), np.empty(many, np.float32), np.empty(many, np.uint16)
    up_at_0, up_step = up.columns[0], up.columns[1] - up.columns[0]
    low, high, last_column = -BESIDE, np.float32(columns - 1) + BESIDE, np.float32(columns - 1)
    for index in range(len(order)):  # three loops over the lines, for the processor's vectors: only one reads pixels
        at, up_row = np.float32(order[index]), up.rows[order[index]] + up_at_0
        start = strides.origin + order[index] * strides.down
        for u in range(many):
            across = lines.column[u] + at * lines.column_step[u]
            ahead = lines.ahead[u] + at * lines.ahead_step[u]
            fall = lines.fall[u] + at * lines.fall_step[u]
            before, late, beyond = first[u], due[u], last[u]
            inside = (across >= low) & (across < high) & (ahead > ZERO)
            column = np.floor(across + HALF)
            column = column if column > ZERO else ZERO
            column = column if column < last_column else last_column
            pixels[u] = np.int32(column)
            reach[u] = ahead if inside else NOWHERE
            floor = inside & (fall > ZERO) & (camera_height >= nearest * fall)
            ours = camera_height * ahead < range_min * fall
            due[u] = at if floor & (late < ZERO) & (not ours) else late
            first[u] = at if floor & (before < ZERO) else before
            last[u] = at if floor else beyond
        for u in range(many):
            depths[u] = millimetres[start + pixels[u] * strides.right]
        for u in range(many):
            depth, ahead = depths[u], reach[u]
            metres = np.float32(depth) * METRES
            height = metres * (up_step * np.float32(pixels[u]) + up_row) + camera_height
            ours = (metres * ahead < range_min) & (height > -BELOW)
            usable = (ahead > ZERO) & (near <= depth) & (depth <= far) & (not ours)
            heights[index, u] = height if usable else np.float32(np.nan)
    return heights, InView(first, due, last)
