"""How fast the robot may go, by what is known of the ground ahead of it and by what the base may still be doing."""

import math
from typing import NamedTuple

from cliffscan.safety.arc_collision import NO_CONTACT, Contact, first_contact, safe_speed
from cliffscan.safety.inputs import SafetyLimits, Twist
from cliffscan.safety.local_grid import HALF_CELL, LOOK, RollingGrid
from cliffscan.safety.pending_motion import SLOW, PendingMotion
from cliffscan.safety.pose2d import Floats, Pose2D

WIDER = 0.1  # [m] looked at beyond what braking takes
ROUNDING = 1e-6  # [m] by which the same distance differs from one pose to the next


class Obstruction(NamedTuple):
    """What holds the robot back, for people."""

    kind: str  # edge, obstacle, unseen floor, or what was touched
    bearing: float  # [rad] from straight ahead, counter-clockwise
    gap: float  # [m] between it and the robot's hull

    def __str__(self) -> str:
        return f"{self.kind} {_direction(self.bearing)}, {self.gap:.2f} m from the hull"


class SpeedLimit(NamedTuple):
    """What the ground on one side, ahead or behind, leaves of a velocity."""

    factor: float  # 1 for all of it
    distance: float  # [m] the robot can go; beyond what braking takes nobody looks
    obstruction: Obstruction | None = None  # what is in the way


NO_LIMIT = SpeedLimit(1.0, math.inf)
DIRECTIONS = (  # up to which angle from straight ahead [rad]
    (math.radians(25), "ahead"),
    (math.radians(65), "ahead to the {}"),
    (math.radians(115), "to the {}"),
    (math.radians(155), "behind to the {}"),
    (math.inf, "behind"),
)


class VelocityLimiter:
    """Looks along the arcs the robot may take, before it and behind it.

    A cell of the grid that is not free is kept `margin` away from the disc. One that is nearer already may be driven
    past, at no less than the least distance it came to and only while the disc surely touches nothing in it.
    """

    def __init__(self, limits: SafetyLimits, grid: RollingGrid) -> None:
        self._limits, self._grid = limits, grid
        self._pending = PendingMotion(limits.reaction, limits.deceleration)
        self._least = limits.radius + HALF_CELL  # [m] from the middle of a cell whose corner the disc touches
        self._radius = self._least + limits.margin
        self._clearance = {1: self._radius, -1: self._radius}

    def rest(self) -> None:
        """The base stands still."""
        self._pending.rest()

    def send(self, sent: Twist, now: float) -> None:
        """The base is sent this velocity at `now` [s]."""
        self._pending.send(*sent, now)

    def stands(self, now: float) -> bool:
        """Whether the base goes on from before by no more than a turn on the spot may."""
        return max(self._pending.speed(1, now), self._pending.speed(-1, now)) <= SLOW

    def limit(self, side: int, wanted: Twist, pose: Pose2D, age: float | None, now: float) -> SpeedLimit:
        """What is left, by what is ahead (side 1) or behind (-1), of a velocity to be sent.

        The robot is at `pose`. The last scan is `age` [s] old, or none is needed. While the base still goes on from
        before, faster than it could brake on the new arc, it is to brake first and to turn then. A turn on the spot
        touches nothing new.
        """
        linear, angular = wanted
        asks, drift = max(side * linear, 0.0), self._pending.speed(side, now)
        if asks == 0.0 and (drift <= SLOW or angular == 0.0):
            return NO_LIMIT
        curvatures = self._pending.curvatures(side, linear, angular, now)
        latency = self._limits.reaction + (age or 0.0)
        # what lies behind is not seen, and backing away must stay possible: only what is known to be there counts
        contact, points = self._contact(side, max(asks, drift), curvatures, latency, pose, age is not None and side > 0)
        fastest = safe_speed(contact.distance, self._limits.deceleration, latency)
        swerves = len(curvatures) > 1 and drift > max(fastest, SLOW)
        if swerves or asks > fastest:
            return SpeedLimit(
                0.0 if swerves else fastest / asks, contact.distance, self._obstruction(contact, points, pose)
            )
        return NO_LIMIT

    def _contact(
        self, side: int, speed: float, curvatures: list[float], latency: float, pose: Pose2D, unknown_too: bool
    ) -> tuple[Contact, Floats]:
        """Where the robot comes to on the worst of these arcs [1/m], and the points (2, n) [m] that are not free."""
        braking = speed * latency + speed**2 / (2.0 * self._limits.deceleration)
        reach = min(self._radius + braking + WIDER, LOOK)
        points = self._grid.not_free(pose, reach, unknown_too)
        farthest = NO_CONTACT._replace(distance=reach - self._radius)
        if not points.size:
            self._clearance[side] = self._radius
            return farthest, points
        clearance = self._approach(side, points)
        contacts = [first_contact(points, side, each, self._radius, clearance) for each in curvatures]
        return min([*contacts, farthest]), points

    def _obstruction(self, contact: Contact, points: Floats, pose: Pose2D) -> Obstruction | None:
        """What is touched there."""
        if contact.point < 0:
            return None
        x, y = points[:, contact.point]
        kind = self._grid.kind_at(pose.to_world(points[:, contact.point, None]))
        return Obstruction(kind, math.atan2(y, x), max(math.hypot(x, y) - self._least, 0.0))

    def _approach(self, side: int, points: Floats) -> float:
        """The least distance [m] at which anything may be passed, by what came nearest since something is near."""
        nearest = math.sqrt(float((points[0] ** 2 + points[1] ** 2).min(initial=self._radius**2)))
        before = self._clearance[side] if nearest < self._radius else self._radius
        self._clearance[side] = max(min(before, nearest), self._least)
        return self._clearance[side] - ROUNDING


def _direction(bearing: float) -> str:
    side = "left" if bearing > 0.0 else "right"
    return next(text for most, text in DIRECTIONS if abs(bearing) <= most).format(side)
