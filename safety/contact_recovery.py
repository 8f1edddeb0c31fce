"""What the base does by itself when it touches something or stands at an edge: it backs off, and then keeps away."""

import math
from typing import Literal, NamedTuple

import numpy as np

from cliffscan.safety.hull import Hull
from cliffscan.safety.inputs import Contacts, Sides
from cliffscan.safety.pose2d import Floats, Pose2D

BACK = -0.1  # [m/s]
AWAY = 0.4  # [rad/s]
BEYOND = 0.05  # [m] after the release; 0.10 m at most
LONGEST = 0.5  # [m] backward with a sensor that never lets go
SIDE = math.radians(50)  # where on the rim the outer sensors are
ROLLING = 0.005  # [m] back, below which the robot may not have turned about yet
WIDTH = math.radians(15)  # to either side of a sensor that something may have touched

NONE: Sides = (False, False, False)
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
    pressed: bool  # whether the sensor still fires, or the robot only goes a little farther


class ContactRecovery:
    """Backs off from a cliff or a bumper until it is released and a little farther.

    A cliff or a wheel drop that comes on the way back stops the robot until all sensors are released, and so does a
    sensor that never is: there is nothing to see by behind the robot. A second cliff sensor that fires before the robot
    has come to go back only shows more of the same edge, over which it rolled while it braked.
    """

    def __init__(self) -> None:
        self._hit: Hit | None = None
        self._cliffs = NONE  # of the edge from which it backs off
        self._began = self._released = Pose2D(0.0, 0.0, 0.0)
        self._foremost = 0.0  # [m] beyond where it began
        self._halted = ""

    def update(self, contacts: Contacts, pose: Pose2D) -> Reaction | None:
        """What to do now, if anything, by the latest sensors at `pose`."""
        pressed = _hit_of(contacts)
        if self._hit is None and pressed:
            self._begin(contacts, pose)
        hit = self._hit = pressed or self._hit
        if hit is None:
            return None
        self._judge(contacts, pose)
        if pressed and self._distance_back(pose) > LONGEST:
            self._halted = self._halted or f"the {hit.kind} sensor does not let go"
        if pressed or any(contacts.wheel_drops):
            self._released = pose
        elif self._halted or _distance(pose, self._released) >= BEYOND:
            self.clear()
            return None
        if self._halted:
            return Reaction(hit, 0.0, 0.0, self._halted, pressed is not None)
        return Reaction(hit, BACK, TURNS[hit.side], "backing off", pressed is not None)

    def _begin(self, contacts: Contacts, pose: Pose2D) -> None:
        self._cliffs, self._began, self._foremost = contacts.cliffs, pose, 0.0

    def _judge(self, contacts: Contacts, pose: Pose2D) -> None:
        """Stop for what comes on the way back."""
        self._foremost = max(self._foremost, -self._distance_back(pose))
        back = self._foremost + self._distance_back(pose)  # [m] gone back already
        if not any(contacts.cliffs) and back > ROLLING:
            self._cliffs = NONE
        if any(self._cliffs) and back < ROLLING:
            self._cliffs = _either(self._cliffs, contacts.cliffs)
        if _either(self._cliffs, contacts.cliffs) != self._cliffs:
            self._halted = self._halted or "another cliff on the way back"
        elif any(contacts.wheel_drops):
            self._halted = self._halted or "a wheel dropped on the way back"

    def _distance_back(self, pose: Pose2D) -> float:
        """How far [m] behind the place where it began the robot is, by the heading that it had there."""
        x, y = self._began.x - pose.x, self._began.y - pose.y
        return x * math.cos(self._began.theta) + y * math.sin(self._began.theta)

    def clear(self) -> None:
        """Forget what was hit."""
        self._hit, self._halted = None, ""


def touched(hit: Hit, pose: Pose2D, hull: Hull) -> Floats:
    """Points (2, n) [m] of the odometry's frame, on the rim of a robot at `pose`, to be avoided after a hit."""
    bearings = BEARINGS[hit.side] + np.linspace(-WIDTH, WIDTH, 5)
    return pose.to_world(hull.on_rim(bearings))


def _hit_of(contacts: Contacts) -> Hit | None:
    """The sensor to react to: a cliff before a bumper, the centre, or both sides, before one side."""
    sides: dict[Kind, Sides] = {"cliff": contacts.cliffs, "bumper": contacts.bumpers}
    for kind, (left, centre, right) in sides.items():
        if centre or (left and right):
            return Hit(kind, "centre")
        if left or right:
            return Hit(kind, "left" if left else "right")
    return None


def _either(one: Sides, other: Sides) -> Sides:
    """The sensors that fire in one of them."""
    return (one[0] or other[0], one[1] or other[1], one[2] or other[2])


def _distance(one: Pose2D, other: Pose2D) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)
