"""Lines of constant azimuth in the image, and the floor's heights along them.

The vertical plane of a beam cuts the image in a straight line. The floor is followed along it, in one pixel of each row
of the image, from the robot outward. So a camera may lean and look down as it likes: each line is what a level camera
sees in a column.
"""

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
ASLANT = 30.0  # [columns] per row, by which a line may lean at most
BESIDE = np.float32(1.0)  # [columns] beside the outermost ones' middles: half a pixel, and half a beam
NOWHERE = np.float32(-1.0)  # a row


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
    between = ((np.arange(each) + 0.5) / each - 0.5) * grid.increment
    azimuths = (grid.angles()[:, None] + between).ravel()
    with np.errstate(all="ignore"):  # a line that leans as rows do has no column in each
        column, step = azimuth_lines(region, azimuths)
        leads = (np.abs(azimuths) < ABREAST) & (np.abs(step) <= ASLANT) & (np.abs(column) < np.float64(1e6))
    column, step = np.where(leads, column, -2.0 * BESIDE), np.where(leads, step, 0.0)
    forward, left = _along(region.forward, column, step), _along(region.left, column, step)
    cos, sin = np.cos(azimuths), np.sin(azimuths)
    ahead, ahead_step = (f * cos + s * sin for f, s in zip(forward, left, strict=True))
    rise, rise_step = _along(region.up, column, step)
    lines = (column, step, ahead, ahead_step, -rise, -rise_step)
    return BeamLines(*(value.astype(np.float32) for value in lines))


def _along(axis: Affine, column: Floats, step: Floats) -> tuple[Floats, Floats]:
    """An affine quantity along lines: its value in row 0, and what one row more adds."""
    per_column, per_row = axis.columns[1] - axis.columns[0], axis.rows[1] - axis.rows[0]
    return axis.columns[0] + axis.rows[0] + per_column * column, per_column * step + per_row


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


def heights_along(points: FloorPoints, lines: BeamLines, order: Rows) -> tuple[Metres, Metres, Metres]:
    """Heights [m] above the plane along the lines in the rows of `order`, (rows, lines); NaN = no usable return.

    With them the first and the last of these rows in which a line's floor is in the image and no nearer than the
    sensor measures or the robot reaches; (lines,), -1 = none.
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
) -> tuple[Metres, Metres, Metres]:
    many = len(lines.column)
    heights = np.empty((len(order), many), np.float32)
    first, last = np.full(many, NOWHERE), np.full(many, NOWHERE)
    for index in range(len(order)):
        row = order[index]
        at, up_row, start = np.float32(row), up.rows[row], strides.origin + row * strides.down
        for u in range(many):
            across = lines.column[u] + at * lines.column_step[u]
            ahead = lines.ahead[u] + at * lines.ahead_step[u]
            fall = lines.fall[u] + at * lines.fall_step[u]
            inside = (across >= -BESIDE) & (across < columns - 1 + BESIDE) & (ahead > np.float32(0.0))
            column = int(np.floor(across + np.float32(0.5))) if inside else 0
            column = min(max(column, 0), columns - 1)
            depth = millimetres[start + column * strides.right]
            metres = np.float32(depth) * METRES
            usable = inside & (near <= depth) & (depth <= far) & (metres * ahead >= range_min)
            heights[index, u] = metres * (up.columns[column] + up_row) + camera_height if usable else np.nan
            floor = inside & (fall > np.float32(0.0))
            floor = floor & (camera_height >= nearest * fall) & (camera_height * ahead >= range_min * fall)
            first[u] = at if floor & (first[u] < np.float32(0.0)) else first[u]
            last[u] = at if floor else last[u]
    return heights, first, last
