"""A gate, a clock and a robot that obeys at once, for tests of the safety rules."""

import math

import numpy as np

from cliffscan.safety.gate import Safety, Scan, Twist
from cliffscan.safety.local_grid import Pose
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import core

ANGLES = np.radians(np.linspace(-29, 29, 640))
HERE = Pose(0.0, 0.0, 0.0)
TICK = 0.02  # [s]


def taken_at_its_word(ranges, range_max):
    """How far each beam of a scan shows floor that tells nothing of it but its ranges."""
    return np.fmin(np.fmax(ranges, 0.0), range_max)


class Drive:
    """A gate, and a clock that goes on."""

    def __init__(self, ranges=math.inf, **config):
        self.safety, self.now, self.pose = Safety(KobukiConfig(**config), HERE), 100.0, HERE
        self.ranges, self.sensors = ranges, {}

    def tick(self, linear, angular=0.0, *, scan=True, command=True, taken=None):
        self.now += TICK
        if scan:
            ranges = np.broadcast_to(np.asarray(self.ranges, float), ANGLES.shape).copy()
            taken = self.now if taken is None else taken
            edges = np.zeros(len(ranges), bool)
            scan = Scan(ranges, edges, taken_at_its_word(ranges, 4.0), ANGLES)
            self.safety.see(scan, self.pose, taken, self.now)
        self.safety.sense(decode(core(**self.sensors)).core, self.pose)
        if command:
            self.safety.command(Twist(linear, angular), self.now)
        return self.safety.decide(self.now)

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
            self.pose = self.pose.then(Pose(v * TICK, 0.0, w * TICK))
        return self.pose
