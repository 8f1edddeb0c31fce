"""Planes that a frame suggests, and which of them most of the floor before the robot agrees with."""

from __future__ import annotations

import numpy as np

from cliffscan.services.capture.floor.belief import Belief
from cliffscan.services.capture.floor.plane_support import misses, support
from cliffscan.services.capture.floor.rays import Floats, Singles

EVERY = 3  # of the beams, one is asked for its opinion on each hypothesis
SHARES = (0.04, 0.08, 0.15, 0.3, 1.0)  # of the rays, nearest first, that hypotheses are made of
HYPOTHESES = 24
POOL = 16  # sets of hypotheses, one after the other


def _triplets() -> Floats:
    """Which rays make a hypothesis, as shares of the count: (POOL, HYPOTHESES, 3)."""
    rng = np.random.default_rng(1)
    share = np.array(SHARES)[np.arange(HYPOTHESES) % len(SHARES)]
    places: Floats = (np.arange(3) + rng.random((POOL, HYPOTHESES, 3))) / 3.0  # one near, one in the middle, one far
    places *= share[:, None]
    return places


TRIPLETS = _triplets()


def hypotheses(inverse: Singles, slopes: Singles, prior: Belief, turn: int) -> Floats:
    """Planes (HYPOTHESES + 1, 3), each through three rays and the prior; the last is the prior's mean.

    inverse: (beams, rings); slopes: (3, beams, rings), both as FloorRays has them; at least one ray is not nan.
    """
    nearest_first = np.flatnonzero(np.isfinite(inverse.T))
    chosen = nearest_first[(TRIPLETS[turn % POOL] * len(nearest_first)).astype(np.intp)]
    ring, beam = np.divmod(chosen, len(inverse))
    rays = slopes[:, beam, ring].transpose(1, 2, 0).astype(np.float64)
    across = rays.transpose(0, 2, 1)
    wrong = inverse[beam, ring] - rays @ prior.mean
    normal = across @ rays + prior.information
    steps = np.linalg.solve(normal, across @ wrong[:, :, None])[:, :, 0]
    return np.vstack([prior.mean + steps, prior.mean])


def best(inverse: Singles, slopes: Singles, planes: Floats, turn: int, noise_scale: float) -> Floats:
    """The plane that explains most floor that begins before the robot."""
    some = slice(turn % EVERY, None, EVERY)
    return np.asarray(planes[int(np.argmax(support(misses(inverse[some], slopes[:, some], planes), noise_scale)))])
