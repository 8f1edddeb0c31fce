"""A gate, a clock and a robot that obeys at once, for tests of the safety rules."""

import math

import numpy as np

from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.inputs import NO_COMMAND, Command, Contacts, Twist
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.scan_claims import Scan
from cliffscan.services.kobuki.config import KobukiConfig

ANGLES = np.radians(np.linspace(-29, 29, 160))
HERE = Pose2D(0.0, 0.0, 0.0)
TICK = 0.02  # [s]
LIMITS = KobukiConfig().limits()


def taken_at_its_word(ranges, range_max):
    """How far each beam of a scan shows floor that tells nothing of it but its ranges."""
    return np.fmin(np.fmax(ranges, 0.0), range_max)


def contacts(bumper=0, cliff=0, drop=0, over=0, button=False):
    """Contacts by bits: 4 left, 2 centre, 1 right; of wheels 2 left, 1 right."""
    wheels = [(bool(bits & 2), bool(bits & 1)) for bits in (drop, over)]
    sides = [(bool(bits & 4), bool(bits & 2), bool(bits & 1)) for bits in (cliff, bumper)]
    return Contacts(*sides, *wheels, button)


class Drive:
    """A gate, and a clock that goes on."""

    def __init__(self, ranges=math.inf, **limits):
        self.safety, self.now, self.pose = SafetyGate(LIMITS._replace(**limits), HERE), 100.0, HERE
        self.ranges, self.sensors, self.command = ranges, {}, NO_COMMAND

    def tick(self, linear, angular=0.0, *, scan=True, command=True, taken=None):
        self.now += TICK
        if scan:
            ranges = np.broadcast_to(np.asarray(self.ranges, float), ANGLES.shape).copy()
            taken = self.now if taken is None else taken
            edges = np.zeros(len(ranges), bool)
            scan = Scan(ranges, edges, taken_at_its_word(ranges, 4.0), ANGLES)
            self.safety.see(scan, self.pose, taken, self.now)
        self.safety.sense(contacts(**self.sensors), self.pose)
        if command:
            self.command = Command(Twist(linear, angular), self.now)
        return self.decide()

    def decide(self):
        return self.safety.decide(self.command, self.now)

    def steady(self, linear, angular=0.0, ticks=150, **how):
        """The decision once every acceleration is over; the robot is held in place."""
        for _ in range(ticks):
            decision = self.tick(linear, angular, **how)
        return decision

    def go(self, linear, angular=0.0, ticks=300, ranges=None):
        """The robot does at once what is decided."""
        for _ in range(ticks):
            if ranges:
                self.ranges = ranges(self.pose)
            v, w = self.tick(linear, angular).allowed
            self.pose = self.pose.then(Pose2D(v * TICK, 0.0, w * TICK))
        return self.pose
