"""The part of a depth image that can carry returns and is worth looking at, and where its pixels' rays go."""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera, scan_axes

Millimetres = NDArray[np.uint16]


class Strides(NamedTuple):
    """Where a region's pixel lies in the image laid out as one line: origin + row·down + column·right."""

    origin: int
    down: int
    right: int


@dataclass(frozen=True, eq=False)
class ImageRegion:
    """Part of an image, in the orientation in which beams run nearer to its columns than to its rows."""

    camera: Camera
    rows: slice  # of the image
    columns: slice
    transposed: bool  # whether rows and columns are exchanged, for a camera on its side
    forward: Affine  # how far a ray leads forward,
    left: Affine  # left
    up: Affine  # and up, per metre of depth: scan_axes of what is looked at

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of what is looked at."""
        return self.up.rows.size, self.up.columns.size

    @property
    def strides(self) -> Strides:
        """Where its pixels lie in the whole image."""
        width = self.camera.width
        origin = self.rows.start * width + self.columns.start
        return Strides(origin, 1, width) if self.transposed else Strides(origin, width, 1)

    def of(self, depth: Millimetres) -> Millimetres:
        """What is looked at of an image (rows, columns) [mm]."""
        part = depth[self.rows, self.columns]
        return np.ascontiguousarray(part.T if self.transposed else part)


@lru_cache(maxsize=8)
def image_region(camera: Camera, lower_than: float) -> ImageRegion:
    """The pixels of camera.region in whose rows anything lower than `lower_than` [m] above the floor can be seen."""
    first_column, first_row, last_column, last_row = camera.region
    columns = slice(first_column, last_column + 1)
    seen = [_part(axis, slice(first_row, last_row + 1), columns) for axis in scan_axes(camera)]
    low = _rows(camera, seen[2], lower_than)
    whole = slice(None)
    forward, left, up = (_part(axis, low, whole) for axis in seen)
    transposed = bool(abs(left.rows[1] - left.rows[0]) > abs(left.columns[1] - left.columns[0]))
    if transposed:
        forward, left, up = (Affine(axis.rows, axis.columns) for axis in (forward, left, up))
    rows = slice(first_row + low.start, first_row + low.stop)
    return ImageRegion(camera, rows, columns, transposed, forward, left, up)


def _part(axis: Affine, rows: slice, columns: slice) -> Affine:
    """A quantity's part in some of the image."""
    return Affine(axis.columns[columns], axis.rows[rows])


def _rows(camera: Camera, up: Affine, lower_than: float) -> slice:
    """From the first to the last such row of those of `up`; two at least, for fewer have no slope."""
    near, far = camera.range
    steepest = up.rows + min(up.columns[0], up.columns[-1])
    lowest = camera.floor.d + steepest * np.where(steepest > 0.0, near, far)
    showing = np.flatnonzero(lowest <= lower_than)
    first, last = (int(showing[0]), int(showing[-1])) if len(showing) else (0, 1)
    first = min(first, len(up.rows) - 2)
    return slice(first, max(last, first + 1) + 1)
