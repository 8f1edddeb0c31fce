"""What is truly there, beam by beam, from a scene's construction: exact at each beam's middle azimuth.

An edge must be found where it is in sight, near, and long enough along the beam.
"""

import math

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats
from cliffscan.simulator.truth import BODY
from evaluation.scenes.polygons import crossing
from evaluation.scenes.scene import Scene
from evaluation.truth.beam_truth import Truth
from evaluation.truth.sight import ROWS_BEFORE, SURE, in_view, lost_from, row_spacing, unobstructed

FARTHEST = 3.0  # [m] edges beyond are not asked for
SHORTEST = 0.20  # [m] of hole along the beam
LONG = (SHORTEST, math.inf)
LEAST_ALLOWED = 0.02  # [m]
EARLY = 0.05  # [m] beyond twice the allowed error, a number before the edge is false
SINKING = 0.5  # [m] of a ramp that is seen before it is lost


def truth_of(scene: Scene, camera: Camera, angles: Floats, lengths: tuple[float, float] = LONG) -> Truth:
    """The truth of a scene for beams of these azimuths (n,) [rad], evenly spaced.

    camera: where it truly is; lengths [m]: the least and the most of hole along a beam whose edge must be found.
    """
    edge, end = first_drop(scene, angles)
    obstacle = first_obstacle(scene, angles)
    end = np.minimum(end, np.maximum(edge, obstacle))
    length = np.subtract(end, edge, out=np.zeros(len(angles)), where=np.isfinite(edge))
    allowed = allowed_error(camera, angles, edge)
    asked = (edge <= FARTHEST) & (length >= lengths[0]) & (length <= lengths[1]) & (obstacle > edge)
    before = edge - ROWS_BEFORE * row_spacing(camera, angles, edge)
    asked &= in_view(camera, angles, edge, lengths[0])
    asked &= unobstructed(scene, camera, angles, edge) & unobstructed(scene, camera, angles, before)
    oblique = asked & (spread(scene, angles) > allowed)
    lost, seen = lost_from(scene.ramp, camera, angles, SURE * scene.grazing)
    first = np.minimum(earliest(edge, allowed), earliest(lost, allowed_error(camera, angles, lost)))
    undecidable = np.isfinite(lost)
    sinking = undecidable & (seen >= SINKING)
    return Truth(edge, allowed, around(first), asked & ~oblique, oblique, undecidable, sinking)


def allowed_error(camera: Camera, angles: Floats, distance: Floats) -> Floats:
    """What a method may err by at a distance [m]: (n,) [m]."""
    allowed: Floats = np.maximum(LEAST_ALLOWED, row_spacing(camera, angles, distance))
    return allowed


def earliest(distance: Floats, allowed: Floats) -> Floats:
    """Where a number [m] begins to be about what is at that distance [m]."""
    return distance - 2.0 * allowed - EARLY


def first_drop(scene: Scene, angles: Floats) -> tuple[Floats, Floats]:
    """The nearest place [m] where the floor ends, and where it begins again: two of (n,), inf = nowhere."""
    edge, end = np.full(len(angles), math.inf), np.full(len(angles), math.inf)
    for drop in scene.drops:
        enter, leave = crossing(drop.outline, np.zeros(2), steps(angles))
        nearer = (leave > 0.0) & (enter < edge)
        edge, end = np.where(nearer, np.maximum(enter, 0.0), edge), np.where(nearer, leave, end)
    return edge, end


def first_obstacle(scene: Scene, angles: Floats) -> Floats:
    """Distance [m] of the nearest obstacle in the robot's way: (n,), inf = none."""
    nearest = np.full(len(angles), math.inf)
    for piece in scene.obstacles:
        if piece.bottom < BODY[1]:
            enter, leave = crossing(piece.outline, np.zeros(2), steps(angles))
            nearest = np.where(leave > 0.0, np.minimum(nearest, np.maximum(enter, 0.0)), nearest)
    return nearest


def spread(scene: Scene, angles: Floats) -> Floats:
    """How far the edge moves [m] from a beam's middle to either of its borders, at most: (n,)."""
    half = (angles[1] - angles[0]) / 2
    middle, right, left = (first_drop(scene, angles + offset)[0] for offset in (0.0, -half, half))
    with np.errstate(invalid="ignore"):
        moved: Floats = np.fmax(np.abs(right - middle), np.abs(left - middle))
    return moved


def around(first: Floats) -> Floats:
    """The least of each beam and its neighbours: a beam beside a drop sees some of it."""
    padded = np.pad(first, 1, constant_values=math.inf)
    least: Floats = np.minimum(np.minimum(padded[:-2], padded[2:]), first)
    return least


def steps(angles: Floats) -> Floats:
    """A metre along each beam: (n, 2)."""
    return np.column_stack([np.cos(angles), np.sin(angles)])
