"""A smaller depth image that shows nearly as much of what a scan is made of, for a link that is too thin for all.

Rows lead outward and tell distances, so all stay that a scan is made of. Columns lie side by side, and one of two or
three is kept. What those beside it measured goes into it: where they agree, their mean, which errs less than one of
them; where something stands in the way in any of them, that, so that no table's leg falls between two columns.
The mean is sent in steps of the sensor's noise, and a pixel keeps its left neighbour's while it is as likely: what
bits remain are not of the noise.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera, Floating, Intrinsics, Region, check_camera, scan_axes
from cliffscan.common.perception.image_region import Millimetres, image_region

Steps = NDArray[np.float32]  # of inverse depth, 0 = no return

MILLIMETRE, FARTHEST = 1e-3, np.iinfo(np.uint16).max  # [m]; [mm] that an image can hold
STEP = math.sqrt(3.0)  # standard deviations of the noise; a Kinect's own steps are as large
AGREE = 4.0  # standard deviations up to which neighbours measured the same
KEPT = np.float32(1.0)  # steps from its own measurement up to which a pixel has its neighbour's place
STANDS = 0.03  # [m] above the floor, from where on a point is no floor
ABOVE = 0.01  # [m] above the robot, from where on a point is in no scan


def thinned(depth: Millimetres, camera: Camera, every: int, lower_than: float) -> tuple[Millimetres, Camera]:
    """One of `every` columns, 2 or 3, and of the rows those that can show anything lower than `lower_than` [m].

    depth: (rows, columns) [mm]. Of a camera on its side all columns are kept, and some rows. The rows that are left
    out, and what stands higher, are in no scan.
    """
    looked_at = image_region(camera, lower_than)
    rows, columns = looked_at.rows, looked_at.columns
    part = Region(columns.start, rows.start, columns.stop - 1, rows.stop - 1)
    if not _possible(camera.cropped(part)):
        part = camera.region
    left, top, right, bottom = part
    cropped, seen = camera.cropped(part), depth[top : bottom + 1, left : right + 1]
    up, (fx, fy, cx, cy) = scan_axes(cropped)[2].single(), cropped.intrinsics
    if looked_at.transposed:
        small = _lines(seen, Affine(up.rows, up.columns), cropped, every, lower_than)
        intrinsics = Intrinsics(fx, fy / every, cx, (cy - 1.0) / every)
    else:
        small = _lines(seen.T, up, cropped, every, lower_than).T
        intrinsics = Intrinsics(fx / every, fy, (cx - 1.0) / every, cy)
    height, width = small.shape
    sparse = replace(cropped, width=width, height=height, intrinsics=intrinsics)
    return (np.ascontiguousarray(small), sparse) if _possible(sparse) else (depth, camera)


def _lines(seen: Millimetres, up: Affine, camera: Camera, every: int, lower_than: float) -> Millimetres:
    """What is sent of lines that lie side by side, the second and then one of `every`: (lines, pixels) [mm].

    up: how far a pixel's ray rises for each metre of depth, columns for lines and rows for pixels.
    """
    step = STEP * camera.noise
    steps = _steps(step).take(np.pad(seen, ((0, 1), (0, 0)), mode="edge"))
    last = len(steps) - 2
    up = Affine(up.columns[1::every], up.rows)
    merged = _merged((steps[:last:every], steps[1 : last + 1 : every], steps[2::every]), up, camera, lower_than)
    sent = _millimetres(_placed(merged), step)
    _level_high(sent, up, camera, lower_than)
    return sent


@lru_cache(maxsize=2)
def _steps(step: float) -> Steps:
    """The inverse of each depth there is [mm], in steps [1/m]; one at least, for 0 is no return."""
    return np.concatenate([[0.0], np.maximum(1.0 / (MILLIMETRE * step * np.arange(1, FARTHEST + 1)), 1.0)]).astype("f4")


def _merged(beside: tuple[Steps, Steps, Steps], up: Affine, camera: Camera, lower_than: float) -> Steps:
    """What three lines that lie side by side measured: (lines, pixels)."""
    before, own, behind = beside
    nearest = np.maximum(np.maximum(before, behind), own)
    farthest = np.minimum(np.minimum(before, behind), own)
    merged: Steps = (before + own + behind) * np.float32(1.0 / len(beside))
    differ = (nearest - farthest > AGREE / STEP) | ((farthest == 0.0) & (nearest > 0.0))
    lines, pixels = np.nonzero(differ)
    rises = up.columns[lines] + up.rows[pixels]
    merged[lines, pixels] = _of_different(np.stack([line[differ] for line in beside]), rises, camera, lower_than)
    return merged


def _of_different(beside: Steps, rises: Floating, camera: Camera, lower_than: float) -> Steps:
    """What pixels are worth whose neighbours measured something else, or nothing: (pixels,).

    beside: (3, pixels), the second their own; rises: of their rays, for each metre of depth.
    """
    own, nearest, returns = beside[1], beside.max(axis=0), (beside > 0.0).sum(axis=0)
    farthest = np.where(beside > 0.0, beside, nearest).min(axis=0)
    agree = (nearest - farthest <= AGREE / STEP) & ((own > 0.0) | (returns > 1))
    value = np.where(agree, beside.sum(axis=0) / returns, own).astype(np.float32)
    height = rises / (nearest * np.float32(STEP * camera.noise)) + camera.floor.d
    stands = (nearest - value > AGREE / STEP) & (height > STANDS) & (height <= lower_than)
    worth: Steps = np.where(stands, nearest, value)
    return worth


def _placed(merged: Steps) -> Steps:
    """Whole steps: (lines, pixels). A pixel has those of the line before while they are near its own."""
    places: Steps = np.rint(merged)
    apart, near = np.empty_like(merged[0]), np.empty(merged.shape[1], np.bool_)
    for before, here, wanted in zip(places[:-1], places[1:], merged[1:], strict=True):
        np.abs(np.subtract(wanted, before, out=apart), out=apart)
        np.copyto(here, before, where=np.less(apart, KEPT, out=near))
    return places


def _millimetres(places: Steps, step: float) -> Millimetres:
    """The depths [mm] of whole steps [1/m]."""
    depths = np.float32(1.0 / (MILLIMETRE * step)) / np.maximum(places, np.float32(0.5))
    depths[places == 0.0] = 0.0
    return np.minimum(np.rint(depths, out=depths), FARTHEST).astype(np.uint16)


def _level_high(sent: Millimetres, up: Affine, camera: Camera, lower_than: float) -> None:
    """Give one depth, which compresses, to all that stands higher than the robot, in place."""
    far = min(round(camera.range[1] / MILLIMETRE), FARTHEST)
    rising = np.flatnonzero(up.rows + up.columns.max() > 0.0)
    if len(rising) == 0 or lower_than == math.inf:
        return
    part = sent[:, rising[0] : rising[-1] + 1]
    rises = up.columns[:, None] + up.rows[rising[0] : rising[-1] + 1]
    height = rises * np.minimum(part, far) * np.float32(MILLIMETRE) + np.float32(camera.floor.d)
    part[(rises > 0.0) & (part > 0) & (height > lower_than + ABOVE)] = far


def _possible(camera: Camera) -> bool:
    """Whether receivers take it for a real camera: the principal point may lie too far outside a narrow part."""
    try:
        check_camera(camera)
    except ValueError:
        return False
    return True
