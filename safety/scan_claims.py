"""What a scan may claim: no more than the described camera can see, on a sane grid, and nothing of the future."""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.description import TURTLEBOT_2, CameraDescription
from cliffscan.common.contract.evidence import EDGES
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.local_grid import WIDEST
from cliffscan.safety.pose2d import Floats, Pose2D
from cliffscan.safety.visible_floor import VisibleFloor

AHEAD = 0.04  # [s], a frame's time, by which a stamp may be ahead of our clock
WIDEST_BEAM = 0.12  # [rad] half a robot's width where floor is farthest seen to be free
FARTHEST_ANGLE = 2.0 * math.pi  # [rad]
SLACK = math.radians(1.0)  # by which a beam may be aside of the view and still see its outermost pixels


class View(NamedTuple):
    """The part of the floor that a camera can see, from the floor's point below it."""

    camera: Pose2D  # that point, and where the camera looks, on the robot
    floor: VisibleFloor
    farthest: float  # [m]
    right: float  # [rad] azimuths
    left: float

    @classmethod
    def undescribed(cls) -> Self:
        """What is taken for seen where nobody describes the camera: a TurtleBot 2's.

        The contract lets scans come without a description, of a camera of one's own, and a gate that freed nothing then
        would let no such robot drive. So it assumes the mount that it was always built for. A camera that stands higher
        must be described: then nothing is freed that it cannot see.
        """
        return cls(Pose2D(*TURTLEBOT_2), VisibleFloor.undescribed(), math.inf, -WIDEST, WIDEST)

    @classmethod
    def of(cls, camera: CameraDescription) -> Self:
        """What a described camera sees."""
        place = Pose2D(camera.x, camera.y, camera.yaw)
        return cls(place, VisibleFloor.of(camera), camera.farthest, *camera.field_of_view)

    def same(self, other: "View") -> bool:
        """Whether another camera sees the same floor."""
        ours, theirs = ((*each[:1], each.floor.nearest, *each[2:]) for each in (self, other))
        return ours == theirs and np.array_equal(self.floor.borders, other.floor.borders)

    def within(self, free: Floats, angles: Floats) -> Floats:
        """How far [m] beams may show floor, of what they claim: (beams,) each, and angles [rad]."""
        seen = (angles >= self.right - SLACK) & (angles <= self.left + SLACK)
        return np.where(seen, np.minimum(free, self.farthest), 0.0)


class Scan(NamedTuple):
    """A fused scan: (beams,) each."""

    ranges: Floats  # [m] as REP-117 has them
    edges: NDArray[np.bool_]  # whether a number is where the floor ends
    free: Floats  # [m] how far floor was seen
    angles: Floats  # [rad] evenly spaced

    @classmethod
    def of(cls, scan: LaserScan, view: View) -> Self:
        """What a message shows; it frees no more than the view, nor what it says in one breath not to have seen."""
        ranges, angles = scan.ranges.astype(np.float64), scan.grid().angles()
        edges = np.isin(scan.intensities, EDGES) if len(scan.intensities) else np.zeros(len(ranges), np.bool_)
        free = scan.free()
        free[np.isnan(ranges) & (free >= scan.range_max)] = 0.0
        return cls(ranges, edges, view.within(free, angles), angles)


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
