"""Where a ramp goes out of the sensor's sight."""

import math

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats
from evaluation.scenes.scene import Ramp
from evaluation.truth.sight import GRAZING, floor_points, pixels


def lost_from(ramp: Ramp | None, camera: Camera, angles: Floats) -> tuple[Floats, Floats]:
    """Distance [m] at which a ramp, or the floor behind it, goes out of the sensor's sight, and how much of it is seen.

    Two of (n,): inf where it stays in sight as far as the sensor reaches; the stretch [m] from the ramp's start on.
    Out of sight is what is seen at an angle below the sensor's least. On a flat face its sine is the camera's height
    above the face's plane over the distance of the point, so it is lost from one distance on.
    """
    lost = np.full(len(angles), math.inf)
    if ramp is None:
        return lost, lost
    along = np.cos(angles - ramp.heading)
    end = ramp.start + ramp.length
    for start, stop, slope in ((ramp.start, end, ramp.slope), (end, math.inf, 0.0)):
        base = ramp.slope * (start - ramp.start)  # height of the floor where the face starts
        gone = np.maximum(start / along, in_sight(camera.floor.d, base, slope, start, along))
        lost = np.where((gone < stop / along) & (gone < lost), gone, lost)
    _, _, depth = pixels(camera, floor_points(angles, lost))
    return np.where(depth <= camera.range[1], lost, math.inf), lost - ramp.start / along


def in_sight(height: float, base: float, slope: float, start: float, along: Floats) -> Floats:
    """How far [m] along each beam the sensor sees a face: (n,), 0 = not at all.

    The face rises by `slope` from `base` [m], at `start` [m] ahead; the camera is `height` [m] above the floor. Solves
    |p - camera| = above / GRAZING, above being its height over the face's plane, for the distance s of
    p = (s, base + slope (s along - start)).
    """
    offset = base - slope * start - height
    above = -offset / math.hypot(1.0, slope)
    if above <= 0.0:
        return np.zeros(len(along))
    rise = slope * along
    a, b, c = 1.0 + rise**2, rise * offset, offset**2 - (above / GRAZING) ** 2
    return np.asarray((-b + np.sqrt(np.maximum(b * b - a * c, 0.0))) / a)
