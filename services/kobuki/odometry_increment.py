"""What the wheels and the gyro did between two packets, or why that is not known."""

import math
from typing import NamedTuple, Self

from cliffscan.services.kobuki.kinematics import METRES_PER_TICK, WHEEL_SEPARATION
from cliffscan.services.kobuki.protocol.sensors import Core, Inertia

LONGEST_INCREMENT = 0.5  # [s] of the base's clock; the path driven in more is anybody's guess
LONGEST_SILENCE = 1.0  # [s] of our clock; in more, packets were lost: 4 KiB of them fill the port's buffer
FASTEST_WHEEL = 1.5  # [m/s], twice what the base can do
FASTEST_TURN = 5.0  # [rad/s], more than the gyro can measure
LEAD = 0.1  # [s] by which the base's clock may lead before anything was late: its 16-bit stamps and our wake-ups jitter
BACKLOG = 0.5  # [s] after which a third is left of what a late packet saved up: it comes soon or not at all
DRIFT = 0.05  # of a lead that is forgiven each second, so that jitter does not add up
SLACK = 0.02  # [s] by which the sensors' own times may differ from the packets'


class Discontinuity(ValueError):
    """Two readings do not belong to one motion; the text says why."""


class Contradiction(Discontinuity):
    """Two readings that no base can give one after the other, however late they come: one of them is wrong."""


class ClockLead:
    """How far the base's clock may run ahead of ours: as far as packets came late before, and a little.

    Packets come late, never early. So time of the base that passes faster than ours was saved up while ours passed
    alone, in a packet that was late or in a backlog that is read at once. A lead that was not saved up is a lie, and
    with it any speed that is taken from that clock.
    """

    def __init__(self) -> None:
        self._saved = 0.0  # [s], negative where the base's clock leads

    def interrupted(self) -> None:
        """Nobody listened for a while: as much as a port's buffer holds may be read at once."""
        self._saved = LONGEST_SILENCE

    def passed(self, seconds: float, ours: float) -> None:
        """So much [s] passed by the base's clock and by ours. Raises Contradiction."""
        if self._saved > 0.0:
            self._saved *= math.exp(-ours / BACKLOG)
        else:
            self._saved = min(self._saved + DRIFT * ours, 0.0)
        self._saved = min(self._saved + ours - seconds, LONGEST_SILENCE)
        if self._saved < -LEAD:
            self._saved = 0.0
            raise Contradiction(f"the base's clock went on by {seconds:.3f} s within {ours:.3f} s of ours")


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
