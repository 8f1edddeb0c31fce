"""Sees what happens to a robot."""

import math
from typing import NamedTuple

from benchmarks.falls.outcome import Event, Kind
from cliffscan.simulator.world import Pose

STRANDED = 60.0  # [s] in one place, after which the robot will not get away any more
PLACE, TURN = 0.10, math.radians(20.0)  # [m] and [rad] within which it is one place


class Look(NamedTuple):
    """A robot at one moment, as it truly is."""

    time: float  # [s] since the run began
    pose: Pose
    fallen: bool
    bumps: int  # so far
    cliff: bool  # whether a cliff sensor tells of one


class Watch:
    """Notes every event of a run. over: whether the run cannot go on."""

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.over = False
        self._cliff, self._bumps = False, 0
        self._left, self._left_at = Pose(), 0.0

    def look(self, look: Look) -> None:
        """Look at the robot once more."""
        if look.cliff and not self._cliff:
            self._note("cliff", look)
        if look.bumps > self._bumps and not look.fallen:
            self._note("bump", look)
        self._cliff, self._bumps = look.cliff, look.bumps
        if look.fallen:
            self._end("fall", look)
        elif self._stranded(look):
            self._end("stranded", look)

    def _stranded(self, look: Look) -> bool:
        x, y, yaw = look.pose
        away = math.hypot(x - self._left.x, y - self._left.y) > PLACE
        if away or abs(math.remainder(yaw - self._left.yaw, math.tau)) > TURN:
            self._left, self._left_at = look.pose, look.time
        return look.time - self._left_at > STRANDED

    def _end(self, kind: Kind, look: Look) -> None:
        self._note(kind, look)
        self.over = True

    def _note(self, kind: Kind, look: Look) -> None:
        self.events.append(Event(kind, look.time, *look.pose))
