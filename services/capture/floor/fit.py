"""The floor of a frame: the most probable plane of the rays that see one, or why there is none."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.services.capture.floor.belief import Belief, Prior
from cliffscan.services.capture.floor.hypotheses import best, hypotheses
from cliffscan.services.capture.floor.plane_support import misses, run
from cliffscan.services.capture.floor.rays import Flags, Floats, FloorRays, Singles

TOGETHER = 10.0  # neighbouring rays that err alike: a fit's information is counted less by this much
SHORT = 3  # rings before a floor's end that may belong to what begins there, as a ramp's foot
LOSS_SCALE = 4.0  # sigmas at which Tukey's loss stops to care
ROUNDS = (1, 2)  # of least squares on one run of rays, before the run is followed anew
NOISE_SCALES = (1.0, 2.0, 3.0)  # how much worse than a Kinect on a flat floor sensor and floor may be
CLOSE = 0.62  # share of a fit's rays that lie within one sigma where sigma is right; a little less than 0.68
FEWEST = 60  # rays that a floor must have
SHORTEST = (
    3.0  # rings that its beams see of it on the average, in noise scales: of a wall cut by a level plane it is less
)


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
    belief, _, miss, seen = _at_least_noise_scale(inverse, rays.slopes, planes, prior.belief, turn)
    if not prior.allows(belief.mean[None])[0]:
        raise Unseen("no plane is near the mount's")
    height = rays.nominal.d / float(np.linalg.norm(belief.mean))
    return Fit(belief, height * math.sqrt(float(np.mean(np.square(miss / seen)))), len(miss) / count)


def _at_least_noise_scale(inverse: Singles, slopes: Singles, planes: Floats, prior: Belief, turn: int) -> Refined:
    """The best plane at the least noise scale at which its rays scatter like noise."""
    for noise_scale in NOISE_SCALES:
        refined = refine(inverse, slopes, best(inverse, slopes, planes, turn, noise_scale), prior, noise_scale)
        size = len(refined.miss)
        if np.count_nonzero(np.abs(refined.miss) <= noise_scale) >= CLOSE * size:
            break
    if size < max(FEWEST, SHORTEST * noise_scale * np.count_nonzero(refined.floor.any(axis=-1))):
        raise Unseen("too narrow a strip of it")
    return refined
