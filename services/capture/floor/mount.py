"""What is known of the camera's mount: where the floor of the next frame can be, and what each floor seen teaches.

A floor is the mount's plus the robot's own motion of that moment, both normal: a Kalman filter of three numbers.
"""

from __future__ import annotations

import math

import numpy as np

from cliffscan.services.capture.floor.belief import Belief, Prior
from cliffscan.services.capture.floor.rays import RISE, TILT, Floats

WRONG_TILT, WRONG_RISE = math.radians(2.5), 0.025  # [rad], [m] standard deviations of a mount from its nominal
NOD, SWAY, HEAVE = math.radians(1.5), math.radians(0.7), 0.005  # [rad], [rad], [m] and of a robot from its mount
MAX_TILT, MAX_RISE = math.radians(5.5), 0.055  # a mount may be wrong by 5° in pitch and in roll and by 5 cm, not more
SIGMAS = 3.0  # beyond that many standard deviations a plane is not the floor
DRIFT = 1e-4  # of the motion's variance, by which the mount may have changed since the last frame
PATIENCE = 30  # frames without a floor after which the mount may be anywhere near its nominal again
SINK = 0.010  # [m] a floor found again may lie lower than before; what lies lower may be the bottom of a pit


class Mount:
    """Belief in the mount of a camera whose nominal height is `height` [m]. Planes are s, as FloorRays has them."""

    def __init__(self, height: float) -> None:
        self._height = height
        self._motion = _variances(NOD, SWAY, HEAVE / height)
        self._deepest = height + MAX_RISE
        self._missed = 0
        self._known = False
        self._mean, self._covariance = self._nominal()

    def prior(self) -> Prior:
        """Where the next frame's floor is, and where it cannot be."""
        belief = Belief.spread(self._mean, self._covariance + self._motion)
        tilt, rise = (TILT, RISE) if self._known else (MAX_TILT, MAX_RISE)
        highest = min(self._height + rise, self._deepest + SINK)
        lowest = self._height - min(rise, self._height / 2)
        reach = SIGMAS * np.sqrt(np.diag(belief.covariance))
        low, high = belief.mean - reach, belief.mean + reach
        low[2], high[2] = max(low[2], self._height / highest), min(high[2], self._height / lowest)
        return Prior(belief, low, high, math.tan(tilt), self._known)

    @property
    def rise(self) -> float:
        """How much higher [m] than its nominal height the camera stands, as far as it is known."""
        return self._height / float(np.linalg.norm(self._mean)) - self._height

    def learn(self, found: Belief, prior: Belief) -> None:
        """Take in a floor that was found with this prior."""
        gain = self._covariance @ prior.information
        mean = self._mean + gain @ (found.mean - self._mean)
        covariance = self._covariance - gain @ (prior.covariance - found.covariance) @ gain.T
        self._mean, self._covariance = mean, (covariance + covariance.T) / 2 + DRIFT * self._motion
        self._known, self._missed = True, 0

    def miss(self) -> None:
        """No floor was found: after a while the mount is looked for anew, as it may have been pushed."""
        self._missed += 1
        if self._known and self._missed >= PATIENCE:
            known = self._height / float(np.linalg.norm(self._mean))
            self._deepest = min(self._deepest, max(known, self._height))
            self._mean, self._covariance = self._nominal()
            self._known, self._missed = False, 0

    def _nominal(self) -> tuple[Floats, Floats]:
        """Mean and covariance of a mount of which nothing was seen yet."""
        return np.array([0.0, 0.0, 1.0]), _variances(WRONG_TILT, WRONG_TILT, WRONG_RISE / self._height)


def _variances(tilt_forward: float, tilt_left: float, height: float) -> Floats:
    return np.diag(np.square([tilt_forward, tilt_left, height]))
