"""Whatever comes in whatever order: a robot that obeys the gate, late and with weak brakes, drives over nothing.

The world does not move. It has voids, half-planes in which there is no floor, and posts, which a scan shows where they
begin. The camera is blind nearer than BLIND: there it does not show a post at all, and of a void only that there is no
floor at BLIND. So a void must never be driven into forward, seen or not; a post not once it was seen.
"""

import math
from collections import deque

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from services.kobuki.config import KobukiConfig
from services.kobuki.ground import MEMORY, Pose
from services.kobuki.packets import decode
from services.kobuki.safety import REST, Safety, Scan, Twist
from tests.kobuki_stream import core
from tests.kobuki_world import ANGLES, RADIUS, RANGE_MAX, SUBSTEPS, TICK, Wheels, World

CAMERA = KobukiConfig().camera()
FRESH = 0.3 + 1e-9  # [s]

directions = st.floats(-math.pi, math.pi)
voids = st.tuples(directions, st.floats(0.55, 2.5))  # direction and distance [m] of the edge from the start
posts = st.tuples(directions, st.floats(0.45, 2.5), st.floats(0.03, 0.2))
linears = st.sampled_from([0.7, 0.7, 0.4, 0.7, 0.4, 0.2, 0.05, 0.0, -0.1, -0.4, 3.0])
angulars = st.sampled_from([0.0, 0.0, 0.1, -0.1, 0.5, -0.5, 1.0, -1.0, 1.9, -1.9])


class Gate(RuleBasedStateMachine):
    @initialize(
        voids=st.lists(voids, min_size=1, max_size=2),
        posts=st.lists(posts, min_size=1, max_size=4),
        dead=st.sampled_from([0.0, 0.1, 0.2]),
        late=st.sampled_from([0.0, 0.06, 0.12]),
    )
    def begin(self, voids, posts, dead, late):
        self.world, self.wheels, self.late = World(voids, posts), Wheels(dead), late
        self.pose, self.now = Pose(0.0, 0.0, 0.0), 100.0
        self.safety = Safety(KobukiConfig(), self.pose)
        self.asked, self.told_at, self.scan_taken, self.scan_came = REST, -math.inf, -math.inf, -math.inf
        self.scans, self.hidden, self.sensors, self.latched = deque(), (), {}, False
        self.seen = np.empty((2, 0))
        self.fault, self.lost, self.reflex_at = "", False, -math.inf

    @rule(linear=linears, angular=angulars, ticks=st.sampled_from([2, 15, 40, 40, 100, 100]))
    def drive(self, linear, angular, ticks):
        self.drive_on(linear, angular, ticks)

    def drive_on(self, linear, angular, ticks):
        self.asked = Twist(linear, angular)
        self._run(ticks)

    @rule(turns=st.lists(angulars, min_size=2, max_size=6), linear=linears, ticks=st.integers(5, 40))
    def swerve(self, turns, linear, ticks):
        for angular in turns:
            self.drive_on(linear, angular, ticks)

    @rule(angular=st.sampled_from([1.0, -1.0]), linear=linears, quarters=st.integers(1, 2))
    def turn_and_go(self, angular, linear, quarters):
        """Turning on the spot brings what was seen out of view, or into the blind zone."""
        self.drive_on(0.0, 0.0, 30)
        self.drive_on(0.0, angular, 80 * quarters)
        self.drive_on(linear, 0.0, 100)

    @rule()
    def look_at_all(self):
        self.hidden = ()

    @rule(first=st.integers(0, 159), beams=st.integers(1, 160), ticks=st.integers(1, 20))
    def see_less(self, first, beams, ticks):
        self.hidden = slice(first, first + beams)
        self._run(ticks)

    @rule(ticks=st.integers(1, 30), what=st.sampled_from(["scans", "commands", "scan"]))
    def miss(self, ticks, what):
        self._run(ticks, commands=what != "commands", scans=what == "commands", frozen=what == "scan")

    @rule(ticks=st.integers(1, 10), sensors=st.sampled_from([{"drop": 1}, {"over": 2}, {"bumper": 4}, {"cliff": 2}]))
    def sense(self, ticks, sensors):
        self.sensors = sensors
        self._run(ticks)
        self.sensors = {}

    @rule(button=st.booleans())
    def stop(self, button):
        self.latched = True
        if button:
            self.sensors = {"buttons": 1}
            self._run(1)
            self.sensors = {}
        else:
            self.safety.stop("asked to")
        self._run(10)
        self.safety.clear()
        self.latched = False

    @rule(seconds=st.sampled_from([0.1, 0.4, 2.0]))
    def hang(self, seconds):
        """Nothing is decided; the guard stops the base."""
        self.wheels.tell(self.now, REST)
        for _ in range(round(seconds / TICK)):
            self._roll()

    @precondition(lambda self: abs(self.wheels.speed) < 1e-9 and not self.lost)
    @rule()
    def restart(self):
        self.safety.restart(self.pose)
        self.lost = self.world.depth_in_void(self.pose) > -0.35  # what it stands on is then taken for floor
        self.asked, self.told_at, self.scan_taken, self.scan_came = REST, -math.inf, -math.inf, -math.inf
        self.scans.clear()

    def _run(self, ticks, commands=True, scans=True, frozen=False):
        for tick in range(ticks):
            self._scan(scans and tick % 2 == 0, frozen)
            if commands:
                self.safety.command(self.asked, self.now)
                self.told_at = self.now
            self._decide()
            if tick % 5 == 0:
                self._decide()
            self._roll()

    def _scan(self, take, frozen):
        if take:
            camera = self.pose.then(CAMERA)
            ranges = self.world.ranges(camera)
            ranges[self.hidden or slice(0, 0)] = np.nan
            self.scans.append((self.now, self.pose, ranges))
        if frozen and self.scan_taken > -math.inf:
            self.safety.see(self.frozen[0], self.frozen[1], self.scan_taken, self.now)
        while self.scans and self.scans[0][0] + self.late <= self.now:
            self.scan_taken, pose, ranges = self.scans.popleft()
            self.scan_came = self.now
            self.frozen = Scan(ranges, ANGLES, RANGE_MAX), pose
            self.safety.see(*self.frozen, self.scan_taken, self.now)
            hit = np.isfinite(ranges) & (ranges < 2.5)
            points = ranges[hit] * np.stack([np.cos(ANGLES[hit]), np.sin(ANGLES[hit])])
            self.seen = np.hstack([self.seen, pose.then(CAMERA).to_world(points)])

    def _decide(self):
        self.safety.sense(decode(core(**self.sensors)).core, self.pose)
        decision = self.safety.decide(self.now)
        self.wheels.tell(self.now, decision.allowed)
        if decision.rule in ("cliff", "bumper"):
            self.reflex_at = self.now
        self._judge(decision)

    def _judge(self, decision):
        linear, angular = decision.allowed
        assert math.isfinite(linear)
        assert math.isfinite(angular)
        assert abs(linear) <= 0.7 + 1e-9
        assert abs(angular) <= math.radians(110) + 1e-9
        if linear > 0.0:
            assert self.now - self.scan_taken <= FRESH
            assert self.now - self.told_at <= FRESH
            assert not self.latched
            assert not {"drop", "over", "bumper", "cliff"} & self.sensors.keys()
        if self.latched or {"drop", "over"} & self.sensors.keys():
            assert decision.allowed == REST

    def _roll(self):
        for _ in range(SUBSTEPS):
            before = self.world.depth_in_void(self.pose)
            self.pose = self.wheels.step(self.pose, self.now, TICK / SUBSTEPS)
            self.now += TICK / SUBSTEPS
            if self.world.depth_in_void(self.pose) > max(before, 0.0) and not self.lost:
                if self.wheels.speed > 0.0:
                    self.fault = self.fault or f"drove into a void at {self.pose}"
                self.lost = True  # backward, where it cannot see
        self._touch()

    def _touch(self):
        x, y = self.seen[0] - self.pose.x, self.seen[1] - self.pose.y
        over = np.hypot(x, y) < RADIUS
        reflex = self.now - self.reflex_at < 0.5  # backs off without looking
        if over.any() and not reflex and not self.lost and self.wheels.speed:
            self.fault = self.fault or f"drove over {self.seen[:, over][:, 0]}, which was seen, at {self.pose}"
        self.seen = self.seen[:, ~over & (np.maximum(np.abs(x), np.abs(y)) < MEMORY - 0.1)]

    @invariant()
    def nothing_was_driven_over(self):
        assert not getattr(self, "fault", "")


TestGate = Gate.TestCase
TestGate.settings = settings(
    max_examples=20,
    stateful_step_count=20,
    derandomize=True,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
