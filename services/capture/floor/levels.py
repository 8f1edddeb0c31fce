"""Whether two levels of floor begin before the robot, as a pavement and a street do beside a kerb, and which is it."""

from __future__ import annotations

import numpy as np

from cliffscan.services.capture.floor.belief import Belief, Prior
from cliffscan.services.capture.floor.rays import Flags, Floats, Singles

APART = 0.02  # [m] of height; what differs less is one level
SMALLEST = 0.15  # as many rays as this share of the first level's, at least, make a second one
CLEARLY = 3.0  # by how much nearer in squared deviations to the mount's the floor must be than another level


def without(inverse: Singles, floor: Flags, fewest: float) -> Singles:
    """The inverse depths (beams, rings) of the beams on which fewer than `fewest` rays are floor; nan elsewhere."""
    others = np.count_nonzero(floor, axis=1) < fewest
    return np.where(others[:, None], inverse, np.float32(np.nan))


def apart(one: Belief, other: Belief, slopes: Singles, rays: Flags, height: float) -> float:
    """How far another level lies from one [m], in the middle over its rays (beams, rings): more than 0 if it is lower.

    height: [m] of the camera over the nominal floor.
    """
    expected = np.stack([one.mean, other.mean]) @ slopes[:, rays].astype(np.float64)
    return float(np.median(height / np.linalg.norm(one.mean) * (expected[0] / expected[1] - 1.0)))


def clearly_nearer(one: Belief, other: Belief, prior: Prior) -> bool:
    """Whether one plane fits the mount clearly better than the other."""
    return _squared(other.mean, prior.belief) - _squared(one.mean, prior.belief) > CLEARLY


def _squared(plane: Floats, belief: Belief) -> float:
    step = plane - belief.mean
    return float(step @ belief.information @ step)
