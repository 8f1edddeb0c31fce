"""What the base does by itself when it touches something or stands at an edge: it backs off, and then keeps away."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from services.kobuki.ground import Floats, Pose
from services.kobuki.sensors import Bumper, Cliff, Core

BACK = -0.1  # [m/s]
AWAY = 0.4  # [rad/s]
BEYOND = 0.05  # [m] after the release; 0.10 m at most
LONGEST = 0.5  # [m] backward with a sensor that never lets go
SIDE = math.radians(50)  # where on the rim the outer sensors are
WIDTH = math.radians(15)  # to either side of a sensor that something may have touched

Kind = Literal["cliff", "bumper"]
TURNS = {"left": -AWAY, "centre": 0.0, "right": AWAY}
BEARINGS = {"left": SIDE, "centre": 0.0, "right": -SIDE}


class Hit(NamedTuple):
    """A sensor that fired, and on which side."""

    kind: Kind
    side: Literal["left", "centre", "right"]


class Reaction(NamedTuple):
    """What overrides every command, while it lasts."""

    hit: Hit
    linear: float  # [m/s]
    angular: float  # [rad/s]
    note: str


class Reflex:
    """Backs off from a cliff or a bumper until it is released and a little farther.

    A cliff or a wheel drop that comes on the way back stops the robot until all sensors are released, and so does a
    sensor that never is: there is nothing to see by behind the robot.
    """

    def __init__(self) -> None:
        self._hit: Hit | None = None
        self._cliffs = Cliff(0)  # known when it began
        self._began = self._released = Pose(0.0, 0.0, 0.0)
        self._halted = ""

    def update(self, core: Core, pose: Pose) -> Reaction | None:
        """What to do now, if anything, by the latest sensors at `pose`."""
        hit = _hit_of(core)
        if self._hit is None:
            if hit is None:
                return None
            self._hit, self._cliffs, self._began = hit, core.cliff, pose
        if core.cliff & ~self._cliffs:
            self._halted = "another cliff on the way back"
        elif core.wheel_drop:
            self._halted = "a wheel dropped on the way back"
        elif hit and _distance(pose, self._began) > LONGEST:
            self._halted = f"the {hit.kind} sensor does not let go"
        if hit or core.wheel_drop:
            self._released = pose
        elif self._halted or _distance(pose, self._released) >= BEYOND:
            self.clear()
            return None
        if self._halted:
            return Reaction(self._hit, 0.0, 0.0, self._halted)
        return Reaction(self._hit, BACK, TURNS[self._hit.side], "backing off")

    def clear(self) -> None:
        """Forget what was hit."""
        self._hit, self._halted = None, ""


def touched(hit: Hit, pose: Pose, radius: float) -> Floats:
    """Points (2, n) [m] of the odometry's frame, on the rim of a robot at `pose`, that a hit tells to avoid."""
    bearings = BEARINGS[hit.side] + np.linspace(-WIDTH, WIDTH, 5)
    return pose.to_world(radius * np.stack([np.cos(bearings), np.sin(bearings)]))


def _hit_of(core: Core) -> Hit | None:
    """The sensor to react to: a cliff before a bumper, the centre, or both sides, before one side."""
    sides: dict[Kind, tuple[bool, bool, bool]] = {
        "cliff": (bool(core.cliff & Cliff.LEFT), bool(core.cliff & Cliff.CENTRE), bool(core.cliff & Cliff.RIGHT)),
        "bumper": (
            bool(core.bumper & Bumper.LEFT),
            bool(core.bumper & Bumper.CENTRE),
            bool(core.bumper & Bumper.RIGHT),
        ),
    }
    for kind, (left, centre, right) in sides.items():
        if centre or (left and right):
            return Hit(kind, "centre")
        if left or right:
            return Hit(kind, "left" if left else "right")
    return None


def _distance(one: Pose, other: Pose) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)
