"""What the base does by itself when it touches something or stands at an edge: it backs off, and then keeps away."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from cliffscan.safety.local_grid import Floats, Pose
from cliffscan.services.kobuki.protocol.sensors import Bumper, Cliff, Core

BACK = -0.1  # [m/s]
AWAY = 0.4  # [rad/s]
BEYOND = 0.05  # [m] after the release; 0.10 m at most
LONGEST = 0.5  # [m] backward with a sensor that never lets go
SIDE = math.radians(50)  # where on the rim the outer sensors are
ROLLING = 0.005  # [m] back, below which the robot may not have turned about yet
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
    pressed: bool  # whether the sensor still tells of it, or the robot only goes a little farther


class Reflex:
    """Backs off from a cliff or a bumper until it is released and a little farther.

    A cliff or a wheel drop that comes on the way back stops the robot until all sensors are released, and so does a
    sensor that never is: there is nothing to see by behind the robot. A second cliff sensor that fires before the robot
    has come to go back only tells more of the same edge, over which it rolled while it braked.
    """

    def __init__(self) -> None:
        self._hit: Hit | None = None
        self._cliffs = Cliff(0)  # of the edge from which it backs off
        self._began = self._released = Pose(0.0, 0.0, 0.0)
        self._foremost = 0.0  # [m] beyond where it began
        self._halted = ""

    def update(self, core: Core, pose: Pose) -> Reaction | None:
        """What to do now, if anything, by the latest sensors at `pose`."""
        pressed = _hit_of(core)
        if self._hit is None and pressed:
            self._begin(core, pose)
        hit = self._hit = pressed or self._hit
        if hit is None:
            return None
        self._judge(core, pose)
        if pressed and self._distance_back(pose) > LONGEST:
            self._halted = self._halted or f"the {hit.kind} sensor does not let go"
        if pressed or core.wheel_drop:
            self._released = pose
        elif self._halted or _distance(pose, self._released) >= BEYOND:
            self.clear()
            return None
        if self._halted:
            return Reaction(hit, 0.0, 0.0, self._halted, pressed is not None)
        return Reaction(hit, BACK, TURNS[hit.side], "backing off", pressed is not None)

    def _begin(self, core: Core, pose: Pose) -> None:
        self._cliffs, self._began, self._foremost = core.cliff, pose, 0.0

    def _judge(self, core: Core, pose: Pose) -> None:
        """Stop for what comes on the way back."""
        self._foremost = max(self._foremost, -self._distance_back(pose))
        back = self._foremost + self._distance_back(pose)  # [m] gone back already
        if not core.cliff and back > ROLLING:
            self._cliffs = Cliff(0)
        if self._cliffs and back < ROLLING:
            self._cliffs |= core.cliff
        if core.cliff & ~self._cliffs:
            self._halted = self._halted or "another cliff on the way back"
        elif core.wheel_drop:
            self._halted = self._halted or "a wheel dropped on the way back"

    def _distance_back(self, pose: Pose) -> float:
        """How far [m] behind the place where it began the robot is, by the heading that it had there."""
        x, y = self._began.x - pose.x, self._began.y - pose.y
        return x * math.cos(self._began.theta) + y * math.sin(self._began.theta)

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
