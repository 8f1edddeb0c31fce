"""One run: a robot in a world, its perception, its gate and its driver, as fast as the machine can."""

from __future__ import annotations

import time
from collections import deque
from random import Random

import numpy as np

from benchmarks.falls.cases import Case
from benchmarks.falls.driver import Driver
from benchmarks.falls.floor import Floor, arc
from benchmarks.falls.gate import SECOND, Gate
from benchmarks.falls.outcome import Outcome, Point
from benchmarks.falls.perception import perception
from benchmarks.falls.watch import Watch
from common.messages import LaserScan
from services.kobuki.safety import CRAWL
from simulator.kobuki.drive import WheelModel
from simulator.robot import RobotSimulation
from simulator.world import Pose

TICK = 0.01  # [s]
FRAME_PERIOD = (0.07, 0.10)  # [s] between two frames: 10 to 14 Hz
AGE = (0.05, 0.10)  # [s] from a frame to its scan at the gate
COMMAND_PERIOD = 0.05  # [s]
POINT_PERIOD = 0.1  # [s] between two points of the track
ENCODER_NOISE = 0.003  # [√m] 3 mm after 1 m, on top of how the wheels slip
AHEAD = 0.5  # [m] of a commanded arc that must be free for a hold to be without cause


class Trial:
    """A run that goes on for as long as `run` is asked to, or until the robot falls or is stranded."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.random = Random(case.name)
        self.robot = RobotSimulation(case.world, seed=case.seed, wheels=WheelModel(noise=ENCODER_NOISE))
        self.floor = Floor(self.robot.world)
        self.gate = Gate()
        self.track: list[Point] = []
        self.held = self.idle = 0.0  # [s]
        self.watch = Watch()
        self._driver = Driver(tuple(self.floor.low), tuple(self.floor.high), case.speed, self.random)
        self._scan_of = perception(case.mode, self.robot.camera)
        self._coming: deque[tuple[float, LaserScan, Pose]] = deque()  # [s] when it arrives, and where it was taken
        self._frame_due = self._command_due = self._point_due = 0.0
        self._to_base = b""

    def run(self, seconds: float) -> Outcome:
        """Let that much time pass, and tell of it."""
        began = time.perf_counter()
        while self.robot.time < seconds - TICK / 2 and not self.watch.over:
            self.tick()
        places = np.array([(point.x, point.y) for point in self.track])
        return Outcome(
            self.case,
            self.robot.time,
            time.perf_counter() - began,
            tuple(self.watch.events),
            self.floor.area,
            self.floor.visited(places),
            self.held,
            self.idle,
        )

    def tick(self) -> None:
        """Let TICK pass."""
        said = self.robot.step(TICK, self._to_base)
        now = self.robot.time
        self._to_base = self.gate.hear(said, now)
        while self._coming and self._coming[0][0] <= now:
            _, scan, pose = self._coming.popleft()
            self.gate.see(scan, now)
            self._driver.see(pose, scan)
        if now >= self._command_due:
            self._command_due += COMMAND_PERIOD
            self._drive(now)
        if now >= self._frame_due:
            self._frame_due = now + self.random.uniform(*FRAME_PERIOD)
            scan = self._scan_of(self.robot.frame(), round(now * SECOND))
            self._coming.append((now + self.random.uniform(*AGE), scan, self.robot.pose))
        self.watch.look(self.robot, self.gate.core)

    def _drive(self, now: float) -> None:
        asked = self._driver.command(self.robot.pose, self.gate.decision, now)
        self._to_base += self.gate.command(asked, now)
        idle = self._judge()
        if now >= self._point_due:
            self._point_due += POINT_PERIOD
            self.track.append(Point(now, *self.robot.pose, self.gate.decision.rule, idle))

    def _judge(self) -> bool:
        """Whether the gate holds the robot, and without cause."""
        _, allowed, asked, *_ = self.gate.decision
        if abs(asked.linear) < CRAWL or abs(allowed.linear) >= CRAWL:
            return False
        self.held += COMMAND_PERIOD
        idle = self.floor.clear(arc(self.robot.pose, *asked, AHEAD))
        self.idle += COMMAND_PERIOD * idle
        return idle
