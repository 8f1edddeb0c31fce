"""A scripted drive: from where the robot is by its odometry, to what to command."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from cliffscan.common.contract.base_messages import Triple

LINEAR, ANGULAR = 0.30, 0.9  # [m/s], [rad/s] at most: slow enough that the camera sees all that it passes
NEAR, AIMED = 0.08, 0.06  # [m], [rad] at which a step is done
AHEAD = 0.35  # [rad] off the way point within which it drives, beyond which it only turns
STEER, BRAKE = 1.8, 0.9  # [1/s] turn rate for an angle, speed for a distance that is left
SLOWEST, SLOWEST_TURN = 0.08, 0.25  # [m/s], [rad/s]
STUCK = 6.0  # [s] after which a step that the gate does not allow is given up
MOVED = 0.03  # [m], [rad] that count as getting on

Command = tuple[float, float]  # [m/s], [rad/s]


class To(NamedTuple):
    """Drive to a place [m]."""

    x: float
    y: float

    def command(self, pose: Triple) -> Command | None:
        """What to do at this pose; None where the place is reached."""
        x, y, heading = pose
        distance = math.hypot(self.x - x, self.y - y)
        if distance < NEAR:
            return None
        off = wrapped(math.atan2(self.y - y, self.x - x) - heading)
        if abs(off) > AHEAD:
            return 0.0, turn(off)
        return min(LINEAR, max(SLOWEST, BRAKE * distance)), STEER * off


class Look(NamedTuple):
    """Turn on the spot to a heading [degrees], counter-clockwise from where the robot started."""

    degrees: float

    def command(self, pose: Triple) -> Command | None:
        """What to do at this pose; None where the heading is reached."""
        off = wrapped(math.radians(self.degrees) - pose[2])
        return None if abs(off) < AIMED else (0.0, turn(off))


Step = To | Look


class Driver:
    """Takes one step after the other; a step on which the robot does not get on is given up."""

    def __init__(self, steps: Sequence[Step]) -> None:
        self._steps = steps
        self._place: Triple | None = None  # where it last got on, and when [ns]
        self._since = 0
        self.done = 0  # steps that are behind it
        self.given_up: list[Step] = []

    @property
    def finished(self) -> bool:
        """Whether no step is left."""
        return self.done == len(self._steps)

    def command(self, pose: Triple, stamp: int) -> Command:
        """What to do at this pose [m, m, rad] at a time [ns]."""
        if self._place is None or moved(self._place, pose):
            self._place, self._since = pose, stamp
        while not self.finished:
            step = self._steps[self.done]
            command = step.command(pose)
            if command and stamp - self._since < STUCK * 1e9:
                return command
            if command:
                self.given_up.append(step)
            self.done, self._since = self.done + 1, stamp
        return 0.0, 0.0


def wrapped(angle: float) -> float:
    """The same angle [rad] from −π to π."""
    return math.remainder(angle, 2 * math.pi)


def turn(off: float) -> float:
    """Turn rate [rad/s] for an angle [rad] that is left."""
    return math.copysign(min(ANGULAR, max(SLOWEST_TURN, STEER * abs(off))), off)


def moved(before: Triple, now: Triple) -> bool:
    """Whether the robot has got on between two poses."""
    return math.dist(before[:2], now[:2]) > MOVED or abs(wrapped(now[2] - before[2])) > MOVED
