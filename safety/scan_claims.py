"""What a scan may claim: no more than the described camera can see, on a sane grid, and nothing of the future."""

from __future__ import annotations

import math
from typing import NamedTuple, Self

import numpy as np

from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.local_grid import WIDEST, Floats

AHEAD = 0.04  # [s], a frame's time, by which a stamp may be ahead of our clock
WIDEST_BEAM = 0.12  # [rad] half a robot's width where floor is farthest seen to be free
FARTHEST_ANGLE = 2.0 * math.pi  # [rad]
SLACK = math.radians(1.0)  # by which a beam may be aside of the view and still see its outermost pixels


class View(NamedTuple):
    """The part of the floor that a camera can see, from the floor's point below it."""

    nearest: float  # [m] along its axis
    farthest: float  # [m]
    right: float  # [rad] azimuths
    left: float

    @classmethod
    def undescribed(cls, nearest: float) -> Self:
        """What is taken for seen where nobody describes the camera."""
        return cls(nearest, math.inf, -WIDEST, WIDEST)

    @classmethod
    def of(cls, camera: CameraDescription, nearest: float) -> Self:
        """What a described camera sees, `nearest` [m] at the nearest."""
        return cls(max(nearest, camera.nearest_floor), camera.farthest, *camera.field_of_view)

    def within(self, free: Floats, angles: Floats) -> Floats:
        """How far [m] beams may show floor, of what they say: (beams,) each, and angles [rad]."""
        seen = (angles >= self.right - SLACK) & (angles <= self.left + SLACK)
        return np.where(seen, np.minimum(free, self.farthest), 0.0)


def refusal(scan: LaserScan, stamp: int) -> str:
    """Why a scan that came when our clock said `stamp` [ns] is not believed, or nothing."""
    ahead = (scan.stamp - stamp) * 1e-9
    if ahead > AHEAD:
        return f"its stamp is {ahead:.2f} s ahead of this clock: synchronise the clocks"
    if len(scan.ranges) < 2:
        return "it has one beam"
    if scan.angle_increment > WIDEST_BEAM:
        return f"its beams are {math.degrees(scan.angle_increment):.1f} degrees wide"
    if max(abs(scan.angle_min), abs(scan.angle_max)) > FARTHEST_ANGLE:
        return f"its beams lie at {scan.angle_min:g} to {scan.angle_max:g} rad"
    return ""
