"""Whether the wheels do what was commanded, and turn as the gyro does.

While the base drives on, encoders that stand still keep the gate's map where it was, and the edge that it remembers
never comes nearer. Such an odometry must not be driven by.
"""

import math
from collections import deque
from typing import NamedTuple

DRIVEN = 0.5  # [s] for which a wheel must have been commanded to turn, always the same way
SLOWEST = 0.03  # [m/s] of a wheel; what turns more slowly is not judged
STANDS = 0.2  # of the least that was commanded; a wheel that turns more slowly stands
WINDOW = 0.1  # [s] over which a wheel's speed is taken
BRAKED = 1.5  # [s] in which a wheel has surely come to what was commanded, from any speed
REVERSED = BRAKED + DRIVEN  # [s] in which it has surely come to turn the other way
TOO_FAST = 0.1  # [m/s] by which a wheel may turn faster than was commanded
GAP = 0.15  # [s] between two commands; in a longer one the guard may have stopped the base
TURN_WINDOW = 0.3  # [s] over which wheels and gyro are compared
TURN_SLACK = 0.25  # [rad] by which they may differ then: wheels slip when they turn on the spot


class _Sent(NamedTuple):
    at: float  # [s]
    speeds: tuple[float, float]  # [m/s] of the left and the right wheel


class _Read(NamedTuple):
    at: float  # [s] of the base's clock
    ways: tuple[float, float]  # [m] that the wheels have turned
    gyro: float | None  # [rad]


class OdometryMonitor:
    """Takes in what is sent to the wheels and what the encoders and the gyro read; reports what does not fit."""

    def __init__(self, wheel_separation: float) -> None:
        """`wheel_separation` [m] of a base with two driven wheels."""
        self._wheel_separation = wheel_separation
        self.begin()

    def begin(self) -> None:
        """The base was silent or not driven for a while: judge nothing by what was before."""
        self._sent: deque[_Sent] = deque()  # changes only
        self._sent_since = self._sent_at = -math.inf  # [s] first and last of the commands without a gap
        self._read: deque[_Read] = deque()
        self._speeds: list[tuple[str, float]] = []  # each wheel's name and speed [m/s]; none before WINDOW has passed

    def send(self, linear: float, angular: float, now: float) -> None:
        """The base is sent this velocity, [m/s] and [rad/s], at `now` [s]."""
        if now - self._sent_at > GAP:
            self._sent.clear()
            self._sent_since = now
        self._sent_at = now
        half = angular * self._wheel_separation / 2.0
        speeds = (linear - half, linear + half)
        if not self._sent or self._sent[-1].speeds != speeds:
            self._sent.append(_Sent(now, speeds))
        while len(self._sent) > 1 and self._sent[1].at <= now - REVERSED:
            self._sent.popleft()

    def read(self, at: float, left: float, right: float, gyro: float | None) -> None:
        """The encoders' ways [m] and the gyro's angle [rad], unwrapped, at `at` [s] of the base's own clock."""
        self._read.append(_Read(at, (left, right), gyro))
        while len(self._read) > 2 and self._read[1].at <= at - TURN_WINDOW:
            self._read.popleft()
        self._speeds = self._wheel_speeds()

    def stuck(self, now: float) -> str:
        """Which wheel stands although it was commanded to turn, or nothing."""
        if not self._driven(DRIVEN, now):
            return ""
        for wheel, (name, speed) in enumerate(self._speeds):
            if abs(speed) >= STANDS * abs(self._sent[-1].speeds[wheel]):  # so it does not stand
                continue
            commanded = self._commanded(wheel, now - DRIVEN)
            least = max(min(commanded), -max(commanded))
            earlier = self._commanded(wheel, now - REVERSED)
            reversed_ = min(earlier) * max(earlier) < 0.0
            if least >= SLOWEST and not reversed_ and abs(speed) < STANDS * least:
                return f"the {name} wheel is commanded to turn and its encoder stands still"
        return ""

    def runaway(self, now: float) -> str:
        """Which wheel turns faster than was commanded for long, as behind a line that is slow, or nothing."""
        if not self._driven(BRAKED, now):
            return ""
        for wheel, (name, speed) in enumerate(self._speeds):
            if abs(speed) <= abs(self._sent[-1].speeds[wheel]) + TOO_FAST:
                continue
            fastest = max(map(abs, self._commanded(wheel, now - BRAKED)))
            if abs(speed) > fastest + TOO_FAST:
                return f"the {name} wheel turns at {abs(speed):.2f} m/s and was commanded {fastest:.2f} m/s at most"
        return ""

    def contradicted(self) -> str:
        """What the gyro reads against the wheels, or nothing."""
        before = self._since(TURN_WINDOW)
        last = self._read[-1] if self._read else None
        if before is None or last is None or before.gyro is None or last.gyro is None:
            return ""
        left, right = (now - then for now, then in zip(last.ways, before.ways, strict=True))
        wheels, gyro = (right - left) / self._wheel_separation, last.gyro - before.gyro
        if abs(wheels - gyro) < TURN_SLACK * max(1.0, (last.at - before.at) / TURN_WINDOW):
            return ""
        return f"by the wheels it turned {math.degrees(wheels):.0f} degrees, by the gyro {math.degrees(gyro):.0f}"

    def _driven(self, seconds: float, now: float) -> bool:
        """Whether the base was sent commands without a gap for so long."""
        return now - self._sent_since >= seconds and now - self._sent_at <= GAP

    def _commanded(self, wheel: int, since: float) -> list[float]:
        """The speeds [m/s] that a wheel was commanded since then [s], the one that held then included."""
        later = [sent.speeds[wheel] for sent in self._sent if sent.at > since]
        before = [sent.speeds[wheel] for sent in self._sent if sent.at <= since]
        return before[-1:] + later

    def _wheel_speeds(self) -> list[tuple[str, float]]:
        """Each wheel's name and speed [m/s] over the last WINDOW of the base's clock."""
        recent = self._since(WINDOW)
        if recent is None:
            return []
        last = self._read[-1]
        ways = zip(("left", "right"), last.ways, recent.ways, strict=True)
        return [(name, (now - then) / (last.at - recent.at)) for name, now, then in ways]

    def _since(self, seconds: float) -> _Read | None:
        """The last reading that is at least so old [s]; None where there is none."""
        if not self._read:
            return None
        end = self._read[-1].at - seconds + 1e-6
        return next((read for read in reversed(self._read) if read.at <= end), None)
