"""How fast the robot may go, by what is known of the ground ahead of it and by what the base may still be doing."""

import math
from typing import NamedTuple

from cliffscan.safety.arc_collision import NO_CONTACT, Contact, safe_speed
from cliffscan.safety.hull import Disc, Hull
from cliffscan.safety.inputs import SafetyLimits, Twist
from cliffscan.safety.local_grid import HALF_CELL, LOOK, RollingGrid
from cliffscan.safety.pending_motion import SLOW, PendingMotion
from cliffscan.safety.pose2d import Floats, Pose2D

WIDER = 0.1  # [m] looked at beyond what braking takes
TURN = 0  # beside the sides 1 and -1: a turn on the spot
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


class Going(NamedTuple):
    """The fastest that a base may be, and whether it surely does not turn."""

    forward: float  # [m/s]
    backward: float
    straight: bool


STILL = Going(0.0, 0.0, straight=True)
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

    A cell of the grid that is not free is kept `margin` away from the hull. One that is nearer already may be driven
    past, at no less than the least distance it came to and only while the hull surely touches nothing in it.
    """

    def __init__(self, limits: SafetyLimits, grid: RollingGrid) -> None:
        self._limits, self._grid = limits, grid
        self._pending = PendingMotion(limits.reaction, limits.deceleration, limits.angular_deceleration)
        self.hull: Hull = limits.hull()
        self._least = self.hull.rim + HALF_CELL  # [m] to the middle of a cell whose corner the hull touches
        self._kept = self._least + limits.margin
        self._outer = self.hull.outer + HALF_CELL + limits.margin  # [m] from the middle to what is kept free
        self._clearance = {1: self._kept, -1: self._kept, TURN: self._kept}

    def rest(self) -> None:
        """The base stands still."""
        self._pending.rest()

    def send(self, sent: Twist, now: float) -> None:
        """The base is sent this velocity at `now` [s]."""
        self._pending.send(*sent, now)

    def stands(self, now: float) -> bool:
        """Whether the base goes on from before by no more than a turn on the spot may."""
        return max(self._pending.speed(1, now), self._pending.speed(-1, now)) <= SLOW

    def going(self, now: float) -> Going:
        """How the base may be moving."""
        pending = self._pending
        return Going(pending.speed(1, now), pending.speed(-1, now), not pending.turns(now))

    def limit(self, side: int, wanted: Twist, pose: Pose2D, age: float | None, late: float, now: float) -> SpeedLimit:
        """What is left, by what is ahead (side 1) or behind (-1), of a velocity to be sent.

        The robot was at `pose`, `late` [s] before it is decided. The last scan is `age` [s] old, or none is needed.
        While the base still goes on from before, faster than it could brake on the new arc, it is to brake first and to
        turn then. A turn on the spot is limit_turn's.
        """
        linear, angular = wanted
        asks, drift = max(side * linear, 0.0), self._pending.speed(side, now)
        if asks == 0.0 and (drift <= SLOW or angular == 0.0):
            return NO_LIMIT
        spins = [] if self.hull.turns_free else self._pending.spins(now)
        curvatures = self._pending.curvatures(side, linear, angular, now, spins)
        latency = self._limits.reaction + (age or 0.0) + late
        # what lies behind is not seen, and backing away must stay possible: for a disc only
        # what is known to be there counts; any other hull stays on floor that was seen, or it could not turn any more
        unknown_too = age is not None and (side > 0 or not self.hull.turns_free)
        fastest, contact, points = self._fastest(side, max(asks, drift), curvatures, latency, pose, unknown_too)
        swerves = len(curvatures) > 1 and drift > max(fastest, SLOW)
        if swerves or asks > fastest:
            return SpeedLimit(
                0.0 if swerves else fastest / asks, contact.distance, self._obstruction(contact, points, pose)
            )
        return NO_LIMIT

    def limit_turn(self, wanted: Twist, pose: Pose2D, age: float | None, late: float, now: float) -> SpeedLimit:
        """What is left of a velocity that turns the robot on the spot: its corners sweep what lies beside it.

        A robot that drives brakes first. What was never seen counts wherever a scan is needed.
        """
        if self.hull.turns_free or wanted.angular == 0.0 or abs(wanted.linear) > SLOW:
            return NO_LIMIT
        if not self.stands(now):
            return SpeedLimit(0.0, 0.0)
        points = self._grid.not_free(pose, self._outer, age is not None)
        direction = 1 if wanted.angular > 0.0 else -1
        contact = self.hull.on_the_spot(points, direction, self._kept, self._approach(TURN, points))
        latency = self._limits.reaction + (age or 0.0) + late
        fastest = safe_speed(contact.distance, self._limits.angular_deceleration, latency)
        if abs(wanted.angular) <= fastest:
            return NO_LIMIT
        swept = contact.distance * self.hull.outer
        return SpeedLimit(fastest / abs(wanted.angular), swept, self._obstruction(contact, points, pose))

    def _fastest(
        self, side: int, speed: float, curvatures: list[float], latency: float, pose: Pose2D, unknown_too: bool
    ) -> tuple[float, Contact, Floats]:
        """The speed [m/s] from which the robot stops before it touches anything on the worst of these arcs [1/m].

        With it, what it touches first there, and the points (2, n) [m] that are not free.
        """
        slowest = min(map(self._deceleration, curvatures))
        braking = speed * latency + speed**2 / (2.0 * slowest)
        reach = min(self._outer + braking + WIDER, LOOK)
        points = self._grid.not_free(pose, reach, unknown_too)
        nothing = NO_CONTACT._replace(distance=reach - self._outer)
        if not points.size:
            self._clearance[side] = self._kept
            return safe_speed(nothing.distance, slowest, latency), nothing, points
        clearance = self._approach(side, points)
        speeds = []
        for each in curvatures:
            contact = min(self.hull.on_arc(points, side, each, self._kept, clearance), nothing)
            speeds.append((safe_speed(contact.distance, self._deceleration(each), latency), contact))
        return *min(speeds), points

    def _deceleration(self, curvature: float) -> float:
        """With how much [m/s²] the robot brakes on an arc [1/m].

        The outer wheel of two brakes for the turn as well: with `deceleration` a of the wheels and half a track h, the
        turn ends with a / h, and the middle of the robot brakes with a / (1 + h·|curvature|).
        """
        straight = self._limits.deceleration
        if self.hull.turns_free:
            return straight
        return straight / (1.0 + abs(curvature) * straight / self._limits.angular_deceleration)

    def _obstruction(self, contact: Contact, points: Floats, pose: Pose2D) -> Obstruction | None:
        """What is touched there."""
        if contact.point < 0:
            return None
        x, y = points[:, contact.point]
        kind = self._grid.kind_at(pose.to_world(points[:, contact.point, None]))
        gap = float(self.hull.measure(points[:, contact.point, None])[0]) - self._least
        return Obstruction(kind, math.atan2(y, x), max(gap, 0.0))

    def _approach(self, side: int, points: Floats) -> float:
        """The least distance [m] at which anything may be passed, by what came nearest since something is near."""
        nearest = self.hull.nearest(points, self._kept)
        before = self._clearance[side] if nearest < self._kept else self._kept
        self._clearance[side] = max(min(before, nearest), self._least)
        return self._clearance[side] - ROUNDING


def room_to_turn(hull: Hull, margin: float) -> Hull:
    """What the hull covers, or where a turn on the spot sweeps more, what that needs with a margin [m]."""
    return hull if hull.turns_free else Disc(hull.outer + HALF_CELL + margin + ROUNDING)


def _direction(bearing: float) -> str:
    side = "left" if bearing > 0.0 else "right"
    return next(text for most, text in DIRECTIONS if abs(bearing) <= most).format(side)
