"""The part of a depth image that is worth looking at, and where its pixels' rays go."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera, scan_axes

Millimetres = NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class ImageRegion:
    """Rows of an image, in the orientation in which beams run nearer to its columns than to its rows."""

    camera: Camera
    rows: slice  # of the image
    transposed: bool  # whether rows and columns are exchanged, for a camera on its side
    forward: Affine  # how far a ray leads forward,
    left: Affine  # left
    up: Affine  # and up, per metre of depth: scan_axes of what is looked at

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of what is looked at."""
        return self.up.rows.size, self.up.columns.size

    def of(self, depth: Millimetres) -> Millimetres:
        """What is looked at of an image (rows, columns) [mm]."""
        part = depth[self.rows]
        return np.ascontiguousarray(part.T if self.transposed else part)


@lru_cache(maxsize=8)
def image_region(camera: Camera, lower_than: float) -> ImageRegion:
    """The rows in which anything lower than `lower_than` [m] above the floor can be seen."""
    rows = _rows(camera, lower_than)
    intrinsics = camera.intrinsics._replace(cy=camera.intrinsics.cy - rows.start)
    part = scan_axes(replace(camera, height=rows.stop - rows.start, intrinsics=intrinsics))
    _, left, _ = part
    transposed = abs(left.rows[1] - left.rows[0]) > abs(left.columns[1] - left.columns[0])
    forward, left, up = (Affine(axis.rows, axis.columns) if transposed else axis for axis in part)
    return ImageRegion(camera, rows, transposed, forward, left, up)


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
