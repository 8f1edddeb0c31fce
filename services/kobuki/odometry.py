"""Where the Kobuki is, by its wheels and its gyro, and how sure of it one can be.

The errors are those of a random walk with independent increments. One of length d and turn t, in s seconds, has

- a length of variance 1e-4 m · |d|: 1 cm after 1 m;
- by the gyro, a turn of variance 1e-4 rad · |t| + 1e-6 rad²/s · s: 1.4° after a full turn, 3.4° after an hour's drift;
- by the wheels, a turn of variance 5e-3 rad · |t| + 1e-3 rad²/m · |d|: 10° after a full turn, 1.8° after 1 m;

and the pose takes over both through the Jacobians of mid-point integration. Where packets are missing, the base may
have moved unseen: a standard deviation of 0.35 m/s and 0.5 rad/s for as long as nobody looked, 3 s at most, for nobody
drives a silent base. These are deliberately careful figures, not measured ones.
"""

import math
from typing import NamedTuple

from cliffscan.safety.base_clock import ClockLead, Contradiction, Discontinuity
from cliffscan.services.kobuki.covariance import Covariance
from cliffscan.services.kobuki.kinematics import METRES_PER_TICK, WHEEL_SEPARATION
from cliffscan.services.kobuki.odometry_increment import OdometryIncrement, Reading, increment_between
from cliffscan.services.kobuki.protocol.packets import CENTIDEGREE
from cliffscan.services.kobuki.protocol.sensors import Core, Inertia

LENGTH_BY_LENGTH = 1e-4  # [m² / m]
GYRO_BY_TURN = 1e-4  # [rad² / rad]
GYRO_BY_TIME = 1e-6  # [rad² / s]
WHEELS_BY_TURN = 5e-3  # [rad² / rad]
WHEELS_BY_LENGTH = 1e-3  # [rad² / m]
UNSEEN_SPEED = 0.35  # [m/s]
UNSEEN_TURN = 0.5  # [rad/s]
LONGEST_UNSEEN = 3.0  # [s]

SPEED_ERROR = 0.02  # of a speed, by the wheels' diameters
GYRO_ERROR = 0.01  # of an angular velocity, by the gyro's scale
WHEELS_ERROR = 0.05  # of an angular velocity, by the wheels' slip
SIDEWAYS = 0.01  # [m/s], of wheels that cannot roll sideways
UNKNOWN_TWIST = Covariance.of_deviations(0.7, SIDEWAYS, 2.0)  # as fast as the base can be


class Estimate(NamedTuple):
    """Where the robot is in the odometry frame and how it moves in its own: x forward, y left.

    Covariances: of x, y [m] and theta [rad], and of the velocities along x, y [m/s] and about z [rad/s].
    """

    pose: tuple[float, float, float]  # x, y [m], theta [rad] in -π ... π
    twist: tuple[float, float]  # linear [m/s], angular [rad/s]; mean of the last increment
    pose_covariance: Covariance
    twist_covariance: Covariance
    new_baseline: str | None = None  # why this packet's motion is not known, else None
    contradiction: bool = False  # whether that is because the base sent what cannot be


class Odometry:
    """Adds up the increments from packet to packet.

    A packet that does not go on from its predecessor becomes the new baseline: the pose stays where it was, less sure,
    and the twist is taken for zero, not sure at all.
    """

    def __init__(self) -> None:
        self._before: Reading | None = None
        self._interruption: str | None = None
        self._lead = ClockLead()
        self._last = Estimate((0.0, 0.0, 0.0), (0.0, 0.0), Covariance(), UNKNOWN_TWIST)

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where the robot is: x, y [m], theta [rad]."""
        return self._last.pose

    def update(self, core: Core, inertia: Inertia | None, now: float) -> Estimate:
        """The estimate after a packet that came at `now` [s] of a steady clock."""
        after = Reading.of(core, inertia, now)
        try:
            increment = self._increment_to(after)
        except Discontinuity as gap:
            silence = 0.0 if self._before is None else now - self._before.now
            self._last = _without_increment(self._last, silence, gap)
            if not self._last.contradiction:
                self._lead.interrupted()
        else:
            if increment is None:
                return self._last._replace(new_baseline=None, contradiction=False)
            self._last = _with_increment(self._last, increment)
        self._before = after
        return self._last

    def rebaseline(self, why: str) -> None:
        """The next packet does not go on from the last: the port was opened anew, say."""
        self._interruption = why

    def reset(self) -> None:
        """Here is the origin, and ahead is its x axis; the motion goes on."""
        self._last = self._last._replace(pose=(0.0, 0.0, 0.0), pose_covariance=Covariance())

    def _increment_to(self, after: Reading) -> OdometryIncrement | None:
        interruption, self._interruption = self._interruption, None
        if interruption or self._before is None:
            raise Discontinuity(interruption or "first packet")
        increment = increment_between(self._before, after)
        if increment:
            self._lead.passed(increment.seconds, after.now - self._before.now)
        return increment


def _without_increment(last: Estimate, silence: float, why: Discontinuity) -> Estimate:
    """The same place, after `silence` [s] in which the base may have moved."""
    unseen = min(max(silence, 0.0), LONGEST_UNSEEN)
    spread = Covariance.of_deviations(UNSEEN_SPEED * unseen, UNSEEN_SPEED * unseen, UNSEEN_TURN * unseen)
    covariance = last.pose_covariance.plus(spread)
    return Estimate(last.pose, (0.0, 0.0), covariance, UNKNOWN_TWIST, str(why), isinstance(why, Contradiction))


def _with_increment(last: Estimate, increment: OdometryIncrement) -> Estimate:
    """The pose after an increment along an arc, taken as its chord in the direction of the arc's middle."""
    x, y, theta = last.pose
    cos, sin = math.cos(theta + increment.turn / 2.0), math.sin(theta + increment.turn / 2.0)
    dx, dy = increment.distance * cos, increment.distance * sin
    pose = (x + dx, y + dy, math.remainder(theta + increment.turn, math.tau))
    covariance = last.pose_covariance.moved(dx, dy).plus(_increment_covariance(increment, cos, sin))
    twist = (increment.distance / increment.seconds, increment.turn / increment.seconds)
    return Estimate(pose, twist, covariance, _twist_covariance(increment))


def _increment_covariance(increment: OdometryIncrement, cos: float, sin: float) -> Covariance:
    """What an increment in the direction (cos, sin) adds to the pose's: J·diag(of its length, of its turn)·Jᵀ.

    J = [[cos, -d/2·sin], [sin, d/2·cos], [0, 1]] for a length d: half of the turn's error shows in its direction.
    """
    length, turned = abs(increment.distance), abs(increment.turn)
    along = LENGTH_BY_LENGTH * length
    by_gyro = GYRO_BY_TURN * turned + GYRO_BY_TIME * increment.seconds
    by_wheels = WHEELS_BY_TURN * turned + WHEELS_BY_LENGTH * length
    turning = by_gyro if increment.by_gyro else by_wheels
    across_x, across_y = -increment.distance / 2.0 * sin, increment.distance / 2.0 * cos
    return Covariance(
        along * cos * cos + turning * across_x * across_x,
        along * cos * sin + turning * across_x * across_y,
        turning * across_x,
        along * sin * sin + turning * across_y * across_y,
        turning * across_y,
        turning,
    )


def _twist_covariance(increment: OdometryIncrement) -> Covariance:
    """The rounding of the two readings that an increment lies between, and an error proportional to the velocity."""
    tick = METRES_PER_TICK / math.sqrt(6.0) / increment.seconds  # [m/s] by which one wheel's speed is rounded
    speed = math.hypot(tick / math.sqrt(2.0), SPEED_ERROR * increment.distance / increment.seconds)
    rounding = (
        CENTIDEGREE / math.sqrt(6.0) / increment.seconds
        if increment.by_gyro
        else math.sqrt(2.0) * tick / WHEEL_SEPARATION
    )
    turning = math.hypot(
        rounding, (GYRO_ERROR if increment.by_gyro else WHEELS_ERROR) * increment.turn / increment.seconds
    )
    return Covariance.of_deviations(speed, SIDEWAYS, turning)
