"""A place and a heading in the plane."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Pose2D(NamedTuple):
    """A place in the odometry's frame: x, y [m], heading theta [rad]."""

    x: float
    y: float
    theta: float

    def to_world(self, points: Floats) -> Floats:
        """Points (2, n) [m] of this pose's frame, in the odometry's."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = points
        return np.stack([cos * x - sin * y + self.x, sin * x + cos * y + self.y])

    def from_world(self, points: Floats) -> Floats:
        """Points (2, n) [m] of the odometry's frame, in this pose's."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = points[0] - self.x, points[1] - self.y
        return np.stack([cos * x + sin * y, cos * y - sin * x])

    def then(self, other: Pose2D) -> Pose2D:
        """The pose that is `other` seen from this one."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = cos * other.x - sin * other.y, sin * other.x + cos * other.y
        return Pose2D(self.x + x, self.y + y, self.theta + other.theta)

    def seen_from(self, other: Pose2D) -> Pose2D:
        """The same pose in the frame of another one."""
        cos, sin = math.cos(other.theta), math.sin(other.theta)
        x, y = self.x - other.x, self.y - other.y
        return Pose2D(cos * x + sin * y, cos * y - sin * x, self.theta - other.theta)
