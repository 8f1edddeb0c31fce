"""Which part of a camera's image can show floor: a convex polygon, since a plane's inverse depth is affine in (u, v).

A polygon is the rays through its corners, (n, 3): how far each goes forward, left and up for each metre of depth. These
are affine in (u, v) too, so a ray on an edge lies between the edge's ends, and a half-plane of the image is w·ray ≥ c.
"""

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Affine, Camera, Floats, scan_axes

Flags = NDArray[np.bool_]

FORWARD, LEFT, UP = np.eye(3)
ROUNDING = 1e-9  # of a direction


def floor_in_view(camera: Camera) -> Floats:
    """The rays of a camera that meet the floor ahead and within its range.

    They reach out to the centres of the outermost pixels that can carry a return. Floor behind the point below the
    camera, which one that looks steeply down sees, is left out. (0, 3) where there is none; the azimuths and distances
    of the floor in view are at their extremes at the polygon's corners.
    """
    part = scan_axes(camera.cropped(camera.region))
    corners = (Affine(axis.columns[[0, -1]], axis.rows[[0, -1]]).table() for axis in part)
    rays = np.stack([corner.ravel()[[0, 1, 3, 2]] for corner in corners], axis=1)
    near, far = camera.range
    rays = cut(rays, FORWARD, 0.0)
    rays = cut(rays, -far * UP, camera.floor.d)  # the floor is met at the depth d / -up
    return cut(rays, near * UP, -camera.floor.d)


def straight_ahead(rays: Floats) -> Floats:
    """The ends of the line that a polygon (n, 3) covers at azimuth 0, some of them twice; (0, 3) where it has none."""
    _, crossed, crossings = _edges(rays, LEFT, 0.0)
    touching = np.abs(rays @ LEFT) < ROUNDING
    return np.concatenate([crossings[crossed], rays[touching]])


def cut(rays: Floats, weights: Floats, least: float) -> Floats:
    """The part of a convex polygon (n, 3) where weights·ray is at least `least`."""
    inside, crossed, crossings = _edges(rays, weights, least)
    corners = np.stack([rays, crossings], axis=1).reshape(-1, 3)
    return corners[np.stack([inside, crossed], axis=1).ravel()]


def _edges(rays: Floats, weights: Floats, least: float) -> tuple[Flags, Flags, Floats]:
    """Of each edge: whether it begins where weights·ray ≥ least, whether it leaves or enters there, where (n, 3)."""
    margin = rays @ weights - least
    end, end_margin = np.roll(rays, -1, axis=0), np.roll(margin, -1)
    crossed = (margin >= 0.0) != (end_margin >= 0.0)
    share = np.divide(margin, margin - end_margin, out=np.zeros_like(margin), where=crossed)
    return margin >= 0.0, crossed, rays + share[:, None] * (end - rays)
