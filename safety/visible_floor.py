"""Which floor a camera can see at all, by its description: what lies outside is never freed by a scan."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.description import CameraDescription
from cliffscan.safety.pose2d import Floats

Mask = NDArray[np.bool_]

NOD = 0.04  # [m] by which the nearest floor may lie farther: a camera of 0.30 m that nods, or is off, by a degree
SHORTEST = 1e-6  # [m] below which two corners are one, and a border goes through the point below the camera
EVERYWHERE = np.empty((0, 3))
UNDESCRIBED_NEAREST = 0.75  # [m] a TurtleBot 2's Kinect sees floor from 0.71 m on, if it does not nod


class VisibleFloor(NamedTuple):
    """A convex region of the floor, seen from the point below the camera: x ahead, y left."""

    nearest: float  # [m] straight ahead
    borders: Floats  # (k, 3): x, y lies inside where a·x + b·y ≥ c, [m], for every (a, b, c); (a, b) has length 1

    @classmethod
    def undescribed(cls) -> Self:
        """What is taken for seen where nobody describes the camera: what a TurtleBot 2's sees straight ahead."""
        return cls(UNDESCRIBED_NEAREST, EVERYWHERE)

    @classmethod
    def of(cls, camera: CameraDescription) -> Self:
        """What a described camera sees. A description without a polygon limits straight ahead only."""
        return cls(camera.nearest_floor + NOD, _borders(np.array(camera.visible_floor)))

    def holds(self, x: Floats, y: Floats, margin: float = 0.0) -> Mask:
        """Which points, of one shape [m], lie inside by `margin` [m] at least."""
        inside = np.ones(np.shape(x), np.bool_)
        for a, b, c in self.borders:
            inside &= a * x + b * y >= c + margin
        return inside

    def begins_within(self, azimuths: Floats, reach: float) -> Mask:
        """In which directions [rad] floor is seen from `reach` [m] on."""
        return (self.nearest <= reach) & self.holds(reach * np.cos(azimuths), reach * np.sin(azimuths))


def _borders(corners: Floats) -> Floats:
    """The borders of a convex polygon with corners (n, 2) [m]; those that face the camera lie NOD farther off."""
    if len(corners) < 3:
        return EVERYWHERE
    along = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*along.T)
    sides = lengths > SHORTEST
    along = along[sides] / lengths[sides, None]
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    offsets = (inward * corners[sides]).sum(axis=1)
    if (inward @ corners.mean(axis=0) < offsets).any():  # the corners go clockwise
        inward, offsets = -inward, -offsets
    return np.column_stack([inward, offsets + np.where(offsets > SHORTEST, NOD, 0.0)])
