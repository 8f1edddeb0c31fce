"""What is noted of a run while it goes on, and what came of it."""

import math
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.falls.bases import Size
from benchmarks.falls.cases import Case
from benchmarks.falls.floor import Floor, arc
from cliffscan.common.contract.base_messages import Rule
from cliffscan.safety.rules import CRAWL, Decision
from cliffscan.simulator.world import Pose, World

STRANDED = 60.0  # [s] in one place, after which the robot will not get away any more
PLACE, TURN = 0.10, math.radians(20.0)  # [m] and [rad] within which it is one place
POINT_PERIOD = 0.1  # [s] between two points of the track
AHEAD = 0.5  # [m] of a commanded arc that must be free for a hold to be without cause

Kind = Literal["fall", "cliff", "bump", "stranded"]


class Event(NamedTuple):
    """Something that should not happen. cliff: a cliff sensor fired, and the base's reflex backed off."""

    kind: Kind
    time: float  # [s] since the run began
    x: float  # [m] where the robot truly was
    y: float
    yaw: float  # [rad]


class Point(NamedTuple):
    """Where the robot truly was, and what the gate did with the driver's wish."""

    time: float  # [s]
    x: float  # [m]
    y: float
    yaw: float  # [rad]
    rule: Rule
    idle: bool  # held without cause


class Outcome(NamedTuple):
    """A run in figures."""

    case: Case
    seconds: float  # simulated
    wall: float  # [s] that took
    events: tuple[Event, ...]
    area: float  # [m²] that the robot can get to
    visited: float  # share of it
    held: float  # [s] that the gate held the robot
    idle: float  # [s] of these without cause

    def count(self, kind: Kind) -> int:
        """How many events of a kind."""
        return sum(event.kind == kind for event in self.events)


class Look(NamedTuple):
    """A robot at one moment, as it truly is."""

    time: float  # [s] since the run began
    pose: Pose
    fallen: bool
    bumps: int  # so far
    cliff: bool  # whether a cliff sensor fires, or without one a wheel or a caster has no floor below it


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


class Log:
    """A run in a world: where the robot was, when the gate held it, what happened to it."""

    def __init__(self, case: Case, world: World, size: Size) -> None:
        self.floor = Floor(world, size.radius)
        self.watch = Watch()
        self.track: list[Point] = []
        self._case = case
        self._held = self._idle = 0.0  # [s]
        self._point_due = 0.0

    def drove(self, now: float, pose: Pose, decision: Decision, seconds: float) -> None:
        """For so long [s] until now, the gate did that to the driver's wish."""
        held = abs(decision.asked.linear) >= CRAWL > abs(decision.allowed.linear)
        idle = held and self.floor.clear(arc(pose, *decision.asked, AHEAD))
        self._held += seconds * held
        self._idle += seconds * idle
        if now >= self._point_due:
            self._point_due += POINT_PERIOD
            self.track.append(Point(now, *pose, decision.rule, idle))

    def outcome(self, seconds: float, wall: float) -> Outcome:
        """What came of it; seconds: simulated, wall: on the clock."""
        places = np.array([(point.x, point.y) for point in self.track])
        visited = self.floor.visited(places)
        return Outcome(
            self._case, seconds, wall, tuple(self.watch.events), self.floor.area, visited, self._held, self._idle
        )
