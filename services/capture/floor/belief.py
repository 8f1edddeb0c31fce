"""What is believed of a floor: a normal distribution of planes s, as FloorRays writes them, and its limits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cliffscan.services.capture.floor.rays import Flags, Floats


class Belief(NamedTuple):
    """A normal distribution of planes s: mean (3,), covariance (3, 3) and its inverse."""

    mean: Floats
    covariance: Floats
    information: Floats

    @classmethod
    def informed(cls, mean: Floats, information: Floats) -> Belief:
        """The distribution of this mean and inverse covariance."""
        return cls(mean, np.asarray(np.linalg.inv(information), dtype=np.float64), information)

    @classmethod
    def spread(cls, mean: Floats, covariance: Floats) -> Belief:
        """The distribution of this mean and covariance."""
        return cls(mean, covariance, np.asarray(np.linalg.inv(covariance), dtype=np.float64))


class Prior(NamedTuple):
    """Where a floor is and where it cannot be: s outside low to high (3,), or steeper than `slope` either way.

    known: whether floors were seen from this mount before.
    """

    belief: Belief
    low: Floats
    high: Floats
    slope: float
    known: bool

    def allows(self, planes: Floats) -> Flags:
        """Which of the planes (n, 3) can be the floor."""
        within = (planes >= self.low) & (planes <= self.high)
        within[:, :2] &= np.abs(planes[:, :2]) <= self.slope * planes[:, 2:]
        return np.asarray(within.all(axis=1))
