"""A driver that wants to go everywhere: to the edges, into the holes and beyond the walls.

It knows how large the floor plan is and where the robot stands, and nothing of what is there. Mostly it heads for a
near place where it has not been, and learns from the fused scans and from the gate which ways are shut; now and then it
heads straight for any place, inside or outside, whatever it has seen there. When the gate holds the robot for long it
turns away and picks another goal; when the robot does not get away from a place at all it backs off, and where that is
in vain goes on, turns the other way and backs off again.
"""

import math
from random import Random

from benchmarks.falls.bases import Size
from benchmarks.falls.memory import Memory, Place
from benchmarks.falls.sight import SQUARE
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.inputs import Twist
from cliffscan.safety.rules import Decision
from cliffscan.simulator.world import Pose

WHIM = 0.2  # share of the goals that are any place at all
BEYOND = 0.4  # [m] around the floor plan where these may be
CHOICE = 8  # places not visited, of which the one with the least cost becomes the goal
TURNING = 1.0  # [m] by which a way looks longer that begins behind
REACHED = 0.2  # [m]
PATIENCE = 0.5  # [s] that the gate may hold the robot
LONGEST = 8.0  # [m] of driving, in time, after which a goal is given up
LOOKAHEAD = 1.5  # [m]
SLOW = 0.05  # [m/s] below which a robot that is to go is held
AHEAD = math.radians(60.0)  # beyond, it turns on the spot first
STUCK, ESCAPE = 4.0, 2.0  # [s] without moving after which it gets away, and for how long it tries each way to
MOVED, TURNED = 0.15, math.radians(10.0)  # of a robot's own length ahead, and [rad], that count as moving
BACKWARD, FORWARD = Twist(-0.1, 0.0), Twist(0.1, 0.0)
FASTEST_TURN = 1.8  # [rad/s]
GAINS = (1.2, 3.0)  # [1/s] how hard it steers


class Driver:
    """One robot's driver. low, high: corners of the floor plan [m]; speed [m/s]."""

    def __init__(self, low: Place, high: Place, speed: float, random: Random, size: Size) -> None:
        self._speed, self._random = speed, random
        self._memory = Memory(low, high, size)
        self._least = MOVED * size.ahead  # [m] that counts as moving
        self._way: list[Place] = []  # to the goal, which is its last place
        self._whim = False
        self._until = 0.0  # [s] when the goal is given up
        self._held_since: float | None = None
        self._moved, self._moved_at = Pose(), 0.0  # where it last moved to, and when [s]
        self._gain = 1.5
        self._turn = 1.0  # [rad/s] that it last wanted

    def see(self, pose: Pose, scan: LaserScan) -> None:
        """A fused scan came, that was taken while the robot truly was at `pose`."""
        self._memory.see(pose, scan)

    def command(self, pose: Pose, decision: Decision, now: float) -> Twist:
        """What the driver wants now, [s]; it sees what the gate made of its last wish."""
        here = (pose.x, pose.y)
        self._memory.visit(*here)
        if escape := self._escape(pose, now):
            self._way = []
            return escape
        if self._held(decision, now):
            self._memory.shut(*pose)
            self._choose(pose, now, whim=self._random.random() < WHIM / 2)
        elif not self._way or math.dist(here, self._way[-1]) < REACHED or now > self._until:
            self._choose(pose, now, whim=self._random.random() < WHIM)
        x, y = self._target(here)
        return self._towards(math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, math.tau))

    def _towards(self, bearing: float) -> Twist:
        self._turn = min(max(self._gain * bearing, -FASTEST_TURN), FASTEST_TURN)
        return Twist(self._speed if abs(bearing) < AHEAD else 0.0, self._turn)

    def _target(self, here: Place) -> Place:
        """The farthest place of the way that it can head straight for."""
        if self._whim:
            return self._way[-1]
        near = [place for place in self._way if math.dist(here, place) <= LOOKAHEAD]
        seen = (place for place in reversed(near) if self._memory.straight(here, place))
        return next(seen, self._way[-1])

    def _escape(self, pose: Pose, now: float) -> Twist | None:
        """What gets it away from a place where it has not moved for long: back, on, the other way round, back again."""
        tries = math.floor((now - self._moved_at - STUCK) / ESCAPE)  # that are over; negative before the first begins
        ways = BACKWARD, FORWARD, Twist(0.0, -math.copysign(FASTEST_TURN, self._turn)), BACKWARD
        if tries >= len(ways) or (tries != 0 and self._gone(pose)) or (tries < 0 and self._turned(pose)):
            self._moved, self._moved_at = pose, now
            return None
        return ways[tries] if tries >= 0 else None

    def _gone(self, pose: Pose) -> bool:
        return math.dist((pose.x, pose.y), (self._moved.x, self._moved.y)) > self._least

    def _turned(self, pose: Pose) -> bool:
        return abs(math.remainder(pose.yaw - self._moved.yaw, math.tau)) > TURNED

    def _held(self, decision: Decision, now: float) -> bool:
        """Whether the gate has held the robot for long; told once each time."""
        if abs(decision.asked.linear) == 0.0 or abs(decision.allowed.linear) >= SLOW:
            self._held_since = None
        elif self._held_since is None:
            self._held_since = now
        if self._held_since is None or now - self._held_since < PATIENCE:
            return False
        self._held_since = None
        return True

    def _choose(self, pose: Pose, now: float, whim: bool) -> None:
        """Another goal."""
        if self._way and now > self._until:
            self._memory.give_up(self._way[-1])
        self._whim, self._way = whim, [] if whim else self._somewhere_new(pose)
        if not self._way:
            self._whim, self._way = True, [self._anywhere()]
        self._until = now + LONGEST / self._speed
        self._gain = self._random.uniform(*GAINS)

    def _somewhere_new(self, pose: Pose) -> list[Place]:
        """The way to a near one of some places that it has not visited; empty where it knows of none."""
        ways = self._memory.ways((pose.x, pose.y))
        if not ways.new:
            self._memory.begin_again()
            return []
        some = self._random.sample(ways.new, min(CHOICE, len(ways.new)))
        return min(map(ways.to, some), key=lambda way: cost(way, pose))

    def _anywhere(self) -> Place:
        (left, near), (right, far) = self._memory.low, self._memory.high
        between = self._random.uniform
        return between(left - BEYOND, right + BEYOND), between(near - BEYOND, far + BEYOND)


def cost(way: list[Place], pose: Pose) -> float:
    """How long [m] a way is; to turn back costs as much as TURNING."""
    x, y = way[min(len(way) - 1, round(LOOKAHEAD / SQUARE / 2))]
    turn = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, math.tau)
    return SQUARE * len(way) + TURNING * abs(turn) / math.pi
