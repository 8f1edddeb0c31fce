"""How much a sensor errs on a floor: the deviations of its inverse depth from the floor's plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, FloorPlane
from cliffscan.services.capture.floor.plane_support import FLOOR_SIGMAS, before_second, bits, flags, misses
from cliffscan.services.capture.floor.rays import Floats, floor_rays

RELAXED = 4.0  # times the camera's own noise that a sensor may have
NORMAL = 1.4826  # standard deviation of a normal distribution over the median of its deviations


def deviations(depth: NDArray[np.uint16], camera: Camera, floor: FloorPlane) -> Floats:
    """By how much rays that see the floor err, from the nearest outward: (n,) [1/m] of inverse depth.

    depth: (rows, columns) [mm]. Of each of the tracker's beams the rays before its second one off the floor count.
    """
    rays = floor_rays(camera, floor)
    inverse = rays.read(depth)
    plane = np.array([0.0, 0.0, 1.0])
    off = bits(misses(inverse, rays.slopes, plane[None])[0] > FLOOR_SIGMAS * RELAXED)
    on = np.isfinite(inverse) & flags(before_second(off))
    errors = (inverse - np.tensordot(plane.astype(np.float32), rays.slopes, 1)) * rays.sigma
    return np.asarray(errors.T[on.T], dtype=np.float64)


def deviation(errors: Floats) -> float:
    """Their standard deviation, whatever a few of them are."""
    return NORMAL * float(np.median(np.abs(errors - np.median(errors))))
