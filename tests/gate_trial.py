"""A robot that obeys the gate in a world, late and with weak brakes, and what it must never do."""

import math
from collections import deque

import numpy as np

from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.inputs import NO_COMMAND, REST, Command, Contacts, Twist
from cliffscan.safety.local_grid import MEMORY
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.scan_claims import View
from tests.gate_drive import LIMITS, contacts
from tests.gate_world import ANGLES, RADIUS, SUBSTEPS, TICK, Wheels, World

CAMERA = View.undescribed().camera
FRESH = 0.3 + 1e-9  # [s]
REMEMBERED = MEMORY - 0.1  # [m]
BOTH = {"drop": 3}
QUIET = Contacts()


class Trial:
    """Everything raises an AssertionError as soon as the robot drives where it must not."""

    def __init__(self, voids, posts, dead, late, dark):
        self.pose, self.now = Pose2D(0.0, 0.0, 0.0), 100.0
        self.world, self.wheels, self.late, self.dark = World(voids, posts, self.pose), Wheels(dead), late, dark
        self.safety = SafetyGate(LIMITS, self.pose)
        self.asked, self.hidden, self.sensors, self.latched = REST, slice(0, 0), {}, False
        self.seen, self.lost = np.empty((2, 0)), False
        self._know_nothing()

    def _know_nothing(self):
        self.command, self.taken = NO_COMMAND, -math.inf
        self.scans, self.frozen = deque(), None

    def drive(self, linear, angular, ticks):
        self.asked = Twist(linear, angular)
        self.run(ticks)

    def face(self, heading, spin=1.5):
        """Turn on the spot to a heading [rad]."""
        self.drive(0.0, 0.0, 15)
        for _ in range(120):
            aside = math.remainder(heading - self.pose.theta, math.tau)
            if abs(aside) < 0.05:
                break
            self.drive(0.0, math.copysign(min(spin, max(4 * abs(aside), 0.2)), aside), 2)
        self.drive(0.0, 0.0, 12)

    def approach(self, heading, gap):
        """Come as near as `gap` [m] to what is there."""
        self.face(heading)
        for _ in range(60):
            if self.world.room(self.pose, heading) < gap + 0.1:
                break
            self.drive(0.4, 0.0, 5)

    def sense(self, ticks, **sensors):
        self.sensors = sensors
        self.run(ticks)
        self.sensors = {}

    def stop(self, button):
        self.latched = True
        if button:
            self.sense(1, button=True)
        else:
            self.safety.stop("asked to")
        self.run(10)
        self.safety.clear()
        self.latched = False

    def hang(self, seconds):
        """Nothing is decided; the guard stops the base."""
        self.wheels.tell(self.now, REST)
        for _ in range(round(seconds / TICK)):
            self._roll()

    def restart(self):
        """The odometry was interrupted for so short a time that the robot is still where it was."""
        self.safety.restart(self.pose, 0.6)
        self._know_nothing()

    def carry(self, world=None, still=False):
        """Somebody puts the robot down where the world is another; the odometry does not notice."""
        self.sense(10, **BOTH)
        self.hang(1.0)
        self.sensors = BOTH
        self.world = World(*(world or self.world.drawn), self.pose)
        self.seen, self.lost = np.empty((2, 0)), False
        self.run(3, scans=not still)
        self.sensors = {}
        self.run(1)

    def run(self, ticks, commands=True, scans=True, frozen=False):
        for tick in range(ticks):
            self._scan(scans and tick % 2 == 0, frozen)
            if commands:
                self.command = Command(self.asked, self.now)
            self._decide()
            if tick % 5 == 0:
                self._decide()
            self._roll()

    def _scan(self, take, frozen):
        if take:
            scan = self.world.scan(self.pose.then(CAMERA), self.dark)
            scan.ranges[self.hidden], scan.free[self.hidden] = np.nan, 0.0
            self.scans.append((self.now, self.pose, scan))
        if frozen and self.frozen:
            self.safety.see(*self.frozen, self.now)
        while self.scans and self.scans[0][0] + self.late <= self.now:
            self.taken, pose, scan = self.scans.popleft()
            self.frozen = scan, pose, self.taken
            self.safety.see(*self.frozen, self.now)
            if not self.sensors.keys() & BOTH.keys():
                self._remember(pose.then(CAMERA), scan.ranges)

    def _remember(self, camera, ranges):
        hit = np.flatnonzero(ranges < 2.5)[::2]
        if hit.size:
            points = camera.to_world(ranges[hit] * np.stack([np.cos(ANGLES[hit]), np.sin(ANGLES[hit])]))
            new = points[:, np.hypot(points[0] - self.pose.x, points[1] - self.pose.y) > RADIUS]
            self.seen = np.hstack([self.seen, new])
            if self.seen.shape[1] > 2000:
                self.seen = np.unique(np.round(self.seen, 2), axis=1)

    def _decide(self):
        self.safety.sense(contacts(**self.sensors) if self.sensors else QUIET, self.pose)
        decision = self.safety.decide(self.command, self.now)
        self.wheels.tell(self.now, decision.allowed)
        linear, angular = decision.allowed
        assert abs(linear) <= 0.7 + 1e-9
        assert abs(angular) <= math.radians(110) + 1e-9
        if linear > 0.0:
            assert self.now - self.taken <= FRESH, "drives without a scan"
            assert self.now - self.command.at <= FRESH, "drives without a command"
            assert not {"bumper", "cliff"} & self.sensors.keys(), "drives on"
        if self.latched or {"drop", "over"} & self.sensors.keys():
            assert decision.allowed == REST

    def _roll(self):
        before, depth = self.pose, self.world.depth_in_void(self.pose)
        for _ in range(SUBSTEPS):
            self.pose = self.wheels.step(self.pose, self.now, TICK / SUBSTEPS)
            self.now += TICK / SUBSTEPS
        if self.lost or not self.wheels.speed:
            return
        if self.world.depth_in_void(self.pose) > max(depth, 0.0):
            assert self.wheels.speed < 0.0, f"drove into a void at {self.pose}"
            self.lost = True  # backward, where it cannot see
        self._touch(before)

    def _touch(self, before):
        x, y = self.seen[0] - self.pose.x, self.seen[1] - self.pose.y
        over = x * x + y * y < RADIUS**2
        if over.any():
            was = np.hypot(self.seen[0, over] - before.x, self.seen[1, over] - before.y)
            nearer = np.hypot(x[over], y[over]) < was - 1e-6
            assert not nearer.any(), f"drove over {self.seen[:, over][:, 0]}, which was seen, at {self.pose}"
        self.seen = self.seen[:, np.maximum(np.abs(x), np.abs(y)) < REMEMBERED]
