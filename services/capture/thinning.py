"""A smaller depth image that shows nearly as much of what a scan is made of, for a link that is too thin for all."""

from dataclasses import replace

import numpy as np

from cliffscan.common.contract.camera import Camera, Intrinsics, Region, check_camera
from cliffscan.common.perception.image_region import Millimetres, image_region

EVERY = 2  # columns


def thinned(depth: Millimetres, camera: Camera, lower_than: float) -> tuple[Millimetres, Camera]:
    """Every second column, and of the rows those that can show anything lower than `lower_than` [m].

    depth: (rows, columns) [mm]. Rows lead outward and have the distances, so all of them stay; of a camera on its side
    that is true of its columns. The rows that are left out are in no scan.
    """
    looked_at = image_region(camera, lower_than)
    rows, columns = looked_at.rows, looked_at.columns
    part = Region(columns.start, rows.start, columns.stop - 1, rows.stop - 1)
    if not _possible(camera.cropped(part)):
        part = camera.region
    left, top, right, bottom = part
    across, down = (1, EVERY) if looked_at.transposed else (EVERY, 1)
    small = np.ascontiguousarray(depth[top : bottom + 1 : down, left : right + 1 : across])
    fx, fy, cx, cy = camera.cropped(part).intrinsics
    height, width = small.shape
    intrinsics = Intrinsics(fx / across, fy / down, cx / across, cy / down)
    sparse = replace(camera, width=width, height=height, intrinsics=intrinsics, seen=None)
    return (small, sparse) if _possible(sparse) else (depth, camera)


def _possible(camera: Camera) -> bool:
    """Whether receivers take it for a real camera: the principal point may lie too far outside a narrow part."""
    try:
        check_camera(camera)
    except ValueError:
        return False
    return True
