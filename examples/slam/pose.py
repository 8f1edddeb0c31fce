"""Poses in the plane: x, y [m] and theta [rad], counter-clockwise."""

from __future__ import annotations

import math
from typing import NamedTuple


class Pose(NamedTuple):
    """A place and a heading, seen from some frame."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0

    def then(self, step: Pose) -> Pose:
        """The pose that `step`, as seen from this one, leads to."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x = self.x + cos * step.x - sin * step.y
        y = self.y + sin * step.x + cos * step.y
        return Pose(x, y, wrapped(self.theta + step.theta))

    def step_to(self, other: Pose) -> Pose:
        """`other` as seen from this pose, so that `self.then(self.step_to(other))` is `other`."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = other.x - self.x, other.y - self.y
        return Pose(cos * x + sin * y, cos * y - sin * x, wrapped(other.theta - self.theta))

    def towards(self, other: Pose, share: float) -> Pose:
        """The pose at a `share` of the way to `other`: 0 is here, 1 is there; turns the shorter way round."""
        turn = wrapped(other.theta - self.theta)
        return Pose(
            self.x + share * (other.x - self.x),
            self.y + share * (other.y - self.y),
            wrapped(self.theta + share * turn),
        )


def wrapped(angle: float) -> float:
    """The same direction, from -pi to pi [rad]."""
    return math.remainder(angle, math.tau)
