"""What the base may still be doing of the velocities it was sent before."""

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

SLOW = 0.05  # [m/s] at which the robot stands almost at once
BEND = 0.1  # [1/m] by which two curvatures may differ and be taken for one
FAN = 3  # arcs that stand for all between the two outermost
SLOW_TURN = 0.1  # [rad/s] at which it does not turn any more
SHARP = 0.3  # [m] radius of a turn halfway, for the fan, between going straight and turning on the spot


class PendingMotion:
    """What the base may still be doing: a command shows only after up to `delay` [s], and braking takes its time.

    Without this a robot could swerve at speed from an arc that was found free into something beside it, or be steered
    between two free arcs into what stands between them.
    """

    def __init__(self, delay: float, deceleration: float, angular_deceleration: float) -> None:
        self._delay, self._deceleration, self._angular_deceleration = delay, deceleration, angular_deceleration
        self.rest()

    def rest(self) -> None:
        """The base stands still."""
        self._sent: deque[_Sent] = deque([_Sent(-math.inf, 0.0, 0.0)])
        self._fastest = {1: 0.0, -1: 0.0}  # [m/s] sent, by direction, of what may still hold
        self._speeds = {1: 0.0, -1: 0.0}
        self._spins = {1: 0.0, -1: 0.0}
        self._at = -math.inf

    def send(self, linear: float, angular: float, now: float) -> None:
        """The base is sent this velocity, [m/s] and [rad/s], at `now` [s]."""
        self._speeds = {side: self.speed(side, now) for side in (1, -1)}
        self._spins = {direction: self._spin(direction, now) for direction in (1, -1)}
        self._at = now
        if self._sent[-1][1:] != (linear, angular):
            self._sent.append(_Sent(now, linear, angular))
        while len(self._sent) > 1 and self._sent[1].at + self._delay < now:  # what replaced it has reached the wheels
            self._sent.popleft()
        speeds = [sent.linear for sent in self._sent]
        self._fastest = {1: max(speeds), -1: -min(speeds)}

    def speed(self, side: int, now: float) -> float:
        """The highest speed [m/s], forward (side 1) or backward (-1), that the base may have at `now` [s]."""
        braked = self._speeds[side] - self._deceleration * max(now - self._at, 0.0) if self._speeds[side] else 0.0
        return max(braked, self._fastest[side], 0.0)

    def turns(self, now: float) -> bool:
        """Whether the base may be turning, on the spot or on an arc."""
        return any(abs(sent.angular) > SLOW_TURN for sent in self._sent) or bool(self.spins(now))

    def spins(self, now: float) -> list[float]:
        """The fastest turns on the spot [rad/s], to the left and to the right, that the base may still be in."""
        return [each for way in (1, -1) if abs(each := way * self._spin(way, now)) > SLOW_TURN]

    def curvatures(
        self, side: int, linear: float, angular: float, now: float, spins: Sequence[float] = ()
    ) -> list[float]:
        """Curvatures [1/m] the base may take, in that direction, when sent this velocity; the one asked for first.

        spins: turns on the spot [rad/s] that may still be going on when it begins to drive.
        """
        speed = self.speed(side, now)
        before = [sent.angular / sent.linear for sent in self._sent if side * sent.linear > SLOW]
        before += [spin / linear for spin in spins if side * linear > 0.0]
        after = [angular / linear] if side * linear > 0.0 else [side * angular / SLOW]
        if speed > SLOW and any(abs(each - after[0]) > BEND for each in before or [math.inf]):
            after.append(side * angular / speed)
        both = [math.atan(each * SHARP) for each in before + after]
        least, most = min(both), max(both)
        if most - least < BEND * SHARP:
            return after[:1]
        between = (least + (most - least) * step / (FAN - 1) for step in range(FAN))
        return [after[0], *(math.tan(each) / SHARP for each in between)]

    def _spin(self, direction: int, now: float) -> float:
        """The fastest turn on the spot [rad/s] to that side, left (1) or right (-1), that the base may be in."""
        spin = self._spins[direction]
        braked = spin - self._angular_deceleration * max(now - self._at, 0.0) if spin else 0.0
        return max(
            braked, max((direction * sent.angular for sent in self._sent if abs(sent.linear) <= SLOW), default=0.0), 0.0
        )


class _Sent(NamedTuple):
    """A velocity, and when it was sent."""

    at: float  # [s]
    linear: float  # [m/s]
    angular: float  # [rad/s]
