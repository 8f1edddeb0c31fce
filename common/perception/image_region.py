"""The part of a depth image that can carry returns and is worth looking at, and where its pixels' rays go."""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera, Region, scan_axes

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
    first_column, first_row, last_column, _ = camera.region
    low = _rows(camera.cropped(camera.region), lower_than)
    rows, columns = slice(first_row + low.start, first_row + low.stop), slice(first_column, last_column + 1)
    part = scan_axes(camera.cropped(Region(first_column, rows.start, last_column, rows.stop - 1)))
    _, left, _ = part
    transposed = abs(left.rows[1] - left.rows[0]) > abs(left.columns[1] - left.columns[0])
    forward, left, up = (Affine(axis.rows, axis.columns) if transposed else axis for axis in part)
    return ImageRegion(camera, rows, columns, transposed, forward, left, up)


def _rows(camera: Camera, lower_than: float) -> slice:
    """From the first to the last such row; two at least, for fewer have no slope."""
    _, _, up = scan_axes(camera)
    steepest = up.rows + up.columns.min()
    near, far = camera.range
    lowest = camera.floor.d + steepest * np.where(steepest > 0.0, near, far)
    showing = np.flatnonzero(lowest <= lower_than)
    first, last = (int(showing[0]), int(showing[-1])) if len(showing) else (0, 1)
    first = min(first, camera.height - 2)
    return slice(first, max(last, first + 1) + 1)
