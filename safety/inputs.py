"""What the gate takes in of a base of any make: velocities, contacts, and the limits of its body and its brakes."""

from __future__ import annotations

import math
from typing import NamedTuple

from cliffscan.safety.hull import Corners, Hull, hull_of
from cliffscan.safety.pose2d import Pose2D

Sides = tuple[bool, bool, bool]  # left, centre, right
Wheels = tuple[bool, bool]  # left, right


class Twist(NamedTuple):
    """A velocity: linear [m/s] forward, angular [rad/s] counter-clockwise."""

    linear: float
    angular: float

    def scaled(self, factor: float) -> Twist:
        """The same arc at another speed."""
        return Twist(self.linear * factor, self.angular * factor)


REST = Twist(0.0, 0.0)


class Command(NamedTuple):
    """The velocity that is asked for, and when it came."""

    twist: Twist
    at: float  # [s]


NO_COMMAND = Command(REST, -math.inf)


class Contacts(NamedTuple):
    """What the base feels. A base without one of these sensors leaves it at false."""

    cliffs: Sides = (False, False, False)  # no floor below the sensor
    bumpers: Sides = (False, False, False)  # pressed
    wheel_drops: Wheels = (False, False)  # hanging in the air
    overcurrents: Wheels = (False, False)  # a motor draws too much
    stop_button: bool = False  # the emergency stop on the body is pressed

    def joined(self, later: Contacts) -> Contacts:
        """All that is felt in one of them or in the other."""
        return Contacts(
            _sides(self.cliffs, later.cliffs),
            _sides(self.bumpers, later.bumpers),
            _wheels(self.wheel_drops, later.wheel_drops),
            _wheels(self.overcurrents, later.overcurrents),
            self.stop_button or later.stop_button,
        )


class Motion(NamedTuple):
    """How far the base has gone since it began to report, by its own clock and sensors."""

    clock: float  # [s]
    left: float  # [m] of the left wheel
    right: float  # [m] of the right wheel
    gyro: float | None = None  # [rad], where it has a gyro


class BaseReport(NamedTuple):
    """What the base feels and where it is, by an odometry that never jumps. A text is empty where nothing is wrong."""

    contacts: Contacts
    pose: Pose2D
    motion: Motion | None  # None where it does not go on from the report before
    new_baseline: str = ""  # why it is not known how the robot moved since the report before
    contradiction: bool = False  # whether that is because no base can report this after that
    unmeasured: float = 0.0  # [s] for which it is not known; infinite where nobody can tell


class SafetyLimits(NamedTuple):
    """How fast the base may be, how it brakes, what it can collide with, and what it must not drive without."""

    max_linear: float  # [m/s]
    max_angular: float  # [rad/s]
    acceleration: float  # [m/s²]
    angular_acceleration: float  # [rad/s²]
    deceleration: float  # [m/s²] it brakes with, at the least
    angular_deceleration: float  # [rad/s²] with which a turn on the spot ends, at the least
    reaction: float  # [s] from a decision to its effect
    radius: float  # [m] of the disc that holds the body, where there is no footprint
    footprint: Corners  # [m] of the polygon that holds it, in order; none for a disc
    margin: float  # [m] kept from what is in the way
    start_free: float  # [m] around the place where the robot was put down that is floor
    command_timeout: float  # [s] without a command after which it stands
    stamp_tolerance: float  # [s] by which a command's stamp may differ from our clock
    require_scan: bool  # without a fresh scan it only turns, slowly
    scan_timeout: float  # [s] since the scan was taken, and since it came
    slow_turn: float  # [rad/s] without a scan

    def hull(self) -> Hull:
        """The shape of the body from above."""
        return hull_of(self.radius, self.footprint)


def _sides(one: Sides, other: Sides) -> Sides:
    return one[0] or other[0], one[1] or other[1], one[2] or other[2]


def _wheels(one: Wheels, other: Wheels) -> Wheels:
    return one[0] or other[0], one[1] or other[1]
