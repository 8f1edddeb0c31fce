"""What came of a run."""

from typing import Literal, NamedTuple

from benchmarks.falls.cases import Case
from cliffscan.common.contract.base_messages import Rule

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
