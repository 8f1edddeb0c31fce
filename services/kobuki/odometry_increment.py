"""What the wheels and the gyro did between two packets, or why that is not known."""

import math
from typing import NamedTuple, Self

from cliffscan.safety.base_clock import LONGEST_INCREMENT, LONGEST_SILENCE, SLACK, Contradiction, Discontinuity
from cliffscan.services.kobuki.kinematics import METRES_PER_TICK, WHEEL_SEPARATION
from cliffscan.services.kobuki.protocol.sensors import Core, Inertia

FASTEST_WHEEL = 1.5  # [m/s], twice what the base can do
FASTEST_TURN = 5.0  # [rad/s], more than the gyro can measure


class Reading(NamedTuple):
    """What the odometry needs of a packet."""

    timestamp: int  # [ms] of the base's clock, wraps at 65536
    left: int  # [ticks], wraps at 65536
    right: int
    angle: float | None  # [rad] of the gyro, wraps at ±π; None where the packet has none
    now: float  # [s] of our own steady clock

    @classmethod
    def of(cls, core: Core, inertia: Inertia | None, now: float) -> Self:
        """The reading in a packet that came at `now` [s]."""
        angle = None if inertia is None else inertia.angle
        return cls(core.timestamp, core.left_encoder, core.right_encoder, angle, now)


class OdometryIncrement(NamedTuple):
    """A motion along an arc."""

    distance: float  # [m], negative backwards
    turn: float  # [rad], counter-clockwise
    seconds: float
    by_gyro: bool  # whether the turn is the gyro's, else the wheels'


def increment_between(before: Reading, after: Reading) -> OdometryIncrement | None:
    """The motion from one reading to the next; None where the base's clock stands still, so that nothing is new.

    The turn is the gyro's where both readings have it. Raises Discontinuity where time or motion leap: after lost
    packets, a power cycle, or a pause of either clock.
    """
    silence = after.now - before.now
    if not 0.0 <= silence <= LONGEST_SILENCE:
        raise Discontinuity(f"{silence:.2f} s between two packets")
    seconds = ((after.timestamp - before.timestamp) & 0xFFFF) / 1000.0
    if seconds > LONGEST_INCREMENT:
        raise Discontinuity(f"the base's clock went from {before.timestamp} to {after.timestamp} ms")
    if seconds == 0.0:
        return None
    left, right = _metres(before.left, after.left), _metres(before.right, after.right)
    if max(abs(left), abs(right)) > FASTEST_WHEEL * (seconds + SLACK):
        raise Contradiction(f"the wheels leapt by {left:.2f} and {right:.2f} m in {seconds:.3f} s")
    gyro = _gyro_turn(before, after, seconds)
    turn = (right - left) / WHEEL_SEPARATION if gyro is None else gyro
    return OdometryIncrement((left + right) / 2.0, turn, seconds, gyro is not None)


def _metres(before: int, after: int) -> float:
    """How far a wheel went: the encoder counts 16 bits, and half of them are farther than it gets in an increment."""
    ticks = (after - before + 0x8000 & 0xFFFF) - 0x8000
    return ticks * METRES_PER_TICK


def _gyro_turn(before: Reading, after: Reading, seconds: float) -> float | None:
    if before.angle is None or after.angle is None:
        return None
    turn = math.remainder(after.angle - before.angle, math.tau)
    if abs(turn) > FASTEST_TURN * (seconds + SLACK):
        raise Contradiction(f"the gyro leapt by {math.degrees(turn):.0f} degrees in {seconds:.3f} s")
    return turn
