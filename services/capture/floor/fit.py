"""The floor of a frame: the most probable plane of the rays that see one, or why there is none."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.services.capture.floor.belief import Belief, Prior
from cliffscan.services.capture.floor.hypotheses import best, hypotheses
from cliffscan.services.capture.floor.levels import APART, SMALLEST, apart, clearly_nearer, without
from cliffscan.services.capture.floor.plane_support import FLOOR_SIGMAS, misses, run
from cliffscan.services.capture.floor.rays import Flags, Floats, FloorRays, Singles

TOGETHER = 10.0  # neighbouring rays that err alike: a fit's information is counted less by this much
SHORT = 3  # rings before a floor's end that may belong to what begins there, as a ramp's foot
LOSS_SCALE = 4.0  # sigmas at which Tukey's loss stops to care
ROUNDS = (1, 2)  # of least squares on one run of rays, before the run is followed anew
NOISE_SCALES = (1.0, 2.0, 3.0)  # how much worse than they say on a flat floor sensor and floor may be
CLOSE = 0.62  # share of a fit's rays that lie within one sigma where sigma is right; a little less than 0.68
FEWEST = 60  # rays that a floor must have
SHORTEST = (
    3.0  # rings that its beams see of it on the average, in noise scales: of a wall cut by a level plane it is less
)
UNEVEN = 0.012  # [m] of height by which a floor may lie off its plane
MORE = 1.1  # times as many rays as a plane that is found has of an uneven floor, where the mount has it


class Unseen(Exception):
    """No floor was found; the text says why."""


class Refined(NamedTuple):
    """A plane, the rays it is fitted to (beams, rings), and for these miss and inverse depth in noise sigmas (n,)."""

    belief: Belief
    floor: Flags
    miss: Singles
    seen: Singles


class Fit(NamedTuple):
    """A floor found. residual: rms height [m] of its rays; share: of the rays that may have seen floor."""

    belief: Belief
    residual: float
    share: float


def refine(inverse: Singles, slopes: Singles, start: Floats, prior: Belief, noise_scale: float) -> Refined:
    """The most probable plane near `start`, given the prior and Tukey's loss of each ray of its run."""
    trust = TOGETHER * noise_scale**2
    information = prior.information * trust
    s = start
    for rounds in ROUNDS:
        floor = run(misses(inverse, slopes, s[None])[0], noise_scale, SHORT)
        usable = np.flatnonzero(floor)
        rays, seen = slopes.reshape(3, -1).take(usable, axis=1), inverse.reshape(-1).take(usable)
        for _ in range(rounds):
            miss = seen - s.astype(np.float32) @ rays
            weighted = rays * np.square(
                np.maximum(1.0 - np.square(miss * np.float32(1.0 / (LOSS_SCALE * noise_scale))), 0.0)
            )
            normal = weighted @ rays.T + information
            s = s + np.linalg.solve(normal, weighted @ miss + information @ (prior.mean - s))
    return Refined(Belief.informed(s, normal / trust), floor, miss, seen)


def find(rays: FloorRays, depth: NDArray[np.uint16], prior: Prior, turn: int) -> Fit:
    """The floor of a depth image. Raises Unseen.

    turn: the frame's number, so that each has other hypotheses.
    """
    inverse = rays.read(depth)
    count = int(np.count_nonzero(np.isfinite(inverse)))
    if count < FEWEST:
        raise Unseen("nearly no depth where it can be")
    planes = hypotheses(inverse, rays.slopes, prior.belief, turn)
    planes = planes[prior.allows(planes)]
    if not len(planes):
        raise Unseen("no plane is near the mount's")
    refined = _at_least_noise_scale(inverse, rays.slopes, planes, prior.belief, turn)
    if not prior.allows(refined.belief.mean[None])[0]:
        raise Unseen("no plane is near the mount's")
    if not prior.known:
        _check_uneven(refined, inverse, rays, prior.belief)
        refined = _the_mounts(refined, inverse, rays, prior, turn)
    miss, seen = refined.miss, refined.seen
    height = rays.nominal.d / float(np.linalg.norm(refined.belief.mean))
    return Fit(refined.belief, height * math.sqrt(float(np.mean(np.square(miss / seen)))), len(miss) / count)


def _check_uneven(refined: Refined, inverse: Singles, rays: FloorRays, prior: Belief) -> None:
    """Raise Unseen where the plane is one of a short strip of an uneven floor, of which the mount's plane has more."""
    found, mounted = (_explained(inverse, rays, plane) for plane in (refined.belief.mean, prior.mean))
    if mounted > MORE * found:
        raise Unseen("it is too uneven")


def _explained(inverse: Singles, rays: FloorRays, plane: Floats) -> int:
    """On how many rays from the robot outward a plane has an uneven floor."""
    expected = np.tensordot(plane.astype(np.float32), rays.slopes, 1)
    uneven = np.float32(UNEVEN / rays.nominal.d * np.linalg.norm(plane)) * expected
    sigmas = np.abs(inverse - expected) / np.hypot(1.0, uneven / FLOOR_SIGMAS)
    return int(np.count_nonzero(run(sigmas, 1.0)))


def _the_mounts(refined: Refined, inverse: Singles, rays: FloorRays, prior: Prior, turn: int) -> Refined:
    """The one of two levels that is clearly nearer to the mount's, or the only one. Raises Unseen where neither is.

    A robot stands on one of two levels, and as long as its mount is not known it may be either.
    """
    other = _other_level(refined, inverse, rays, prior, turn)
    if other is None:
        return refined
    lower = apart(refined.belief, other.belief, rays.slopes, other.floor, rays.nominal.d)
    if abs(lower) < APART or clearly_nearer(refined.belief, other.belief, prior):
        return refined
    if clearly_nearer(other.belief, refined.belief, prior):
        return other
    raise Unseen(f"two levels {100 * abs(lower):.0f} cm apart may be it")


def _other_level(refined: Refined, inverse: Singles, rays: FloorRays, prior: Prior, turn: int) -> Refined | None:
    """What begins before the robot where the first level does not, if it can be a floor."""
    rest = without(inverse, refined.floor, SHORTEST)
    if np.count_nonzero(np.isfinite(rest)) < FEWEST:
        return None
    planes = hypotheses(rest, rays.slopes, prior.belief, turn)
    planes = planes[prior.allows(planes)]
    try:
        other = _at_least_noise_scale(rest, rays.slopes, planes, prior.belief, turn) if len(planes) else None
    except Unseen:
        return None
    enough = other and prior.allows(other.belief.mean[None])[0] and len(other.miss) >= SMALLEST * len(refined.miss)
    return other if enough else None


def _at_least_noise_scale(inverse: Singles, slopes: Singles, planes: Floats, prior: Belief, turn: int) -> Refined:
    """The best plane at the least noise scale at which its rays scatter like noise. Raises Unseen."""
    for noise_scale in NOISE_SCALES:
        refined = refine(inverse, slopes, best(inverse, slopes, planes, turn, noise_scale), prior, noise_scale)
        size = len(refined.miss)
        if np.count_nonzero(np.abs(refined.miss) <= noise_scale) >= CLOSE * size:
            break
    if size < max(FEWEST, SHORTEST * noise_scale * np.count_nonzero(refined.floor.any(axis=-1))):
        raise Unseen("too narrow a strip of it")
    return refined
