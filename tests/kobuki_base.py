"""A Kobuki that drives as told, for the odometry's tests."""

import math

from cliffscan.services.kobuki.odometry import Odometry
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import core, inertia

TICKS_PER_METRE = 11724.41658
WHEELS_APART = 0.23
PERIOD = 0.02


class Base:
    """A base with ideal wheels and gyro, whose counters begin wherever one likes."""

    def __init__(self, timestamp=0, encoders=(0, 0), angle=0.0, with_gyro=True):
        self.odometry = Odometry()
        self.now = 100.0
        self.with_gyro = with_gyro
        self.power_cycle(timestamp, encoders, angle)

    def power_cycle(self, timestamp=0, encoders=(0, 0), angle=0.0):
        self.clock = timestamp / 1000
        self.left, self.right = (ticks / TICKS_PER_METRE for ticks in encoders)
        self.angle = angle

    def move(self, linear, angular, seconds=PERIOD):
        """Drive without a packet."""
        self.now += seconds
        self.clock += seconds
        self.left += (linear - angular * WHEELS_APART / 2) * seconds
        self.right += (linear + angular * WHEELS_APART / 2) * seconds
        self.angle += angular * seconds

    def report(self):
        ticks = (round(metres * TICKS_PER_METRE) & 0xFFFF for metres in (self.left, self.right))
        payload = core(round(1000 * self.clock) & 0xFFFF, *ticks)
        if self.with_gyro:
            payload += inertia(round(100 * math.degrees(math.remainder(self.angle, math.tau))))
        feedback = decode(payload)
        return self.odometry.update(feedback.core, feedback.inertia, self.now)

    def drive(self, linear, angular, seconds):
        estimate = self.report()
        for _ in range(round(seconds / PERIOD)):
            self.move(linear, angular)
            estimate = self.report()
        return estimate
