"""One run: a robot in a world, its perception, its gate and its driver, as fast as the machine can."""

import logging
import time
from collections import deque
from collections.abc import Iterator, Sequence
from functools import partial
from random import Random

from benchmarks.falls.bases import RIGS, SECOND, TICK
from benchmarks.falls.cases import Case
from benchmarks.falls.driver import Driver
from benchmarks.falls.log import Log, Look, Outcome
from benchmarks.falls.perception import perception
from cliffscan.common.contract.messages import LaserScan
from cliffscan.simulator.world import Pose
from evaluation.workers import in_order

FRAME_PERIOD = (0.07, 0.10)  # [s] between two frames: 10 to 14 Hz
AGE = (0.05, 0.10)  # [s] from a frame to its scan at the gate
COMMAND_PERIOD = 0.05  # [s]
RENEW = 50  # runs after which a process is replaced

log = logging.getLogger(__name__)


class Trial:
    """A run that goes on for as long as `run` is asked to, or until the robot falls or is stranded."""

    def __init__(self, case: Case) -> None:
        self.random = Random(case.name)
        self.robot = RIGS[case.base](case.world, case.seed, lambda what, why: log.debug("%s: %s", what, why))
        self.log = Log(case, self.robot.world, self.robot.size)
        floor = self.log.floor
        self._driver = Driver(tuple(floor.low), tuple(floor.high), case.speed, self.random, self.robot.size)
        self._scan_of = perception(case.mode, self.robot.camera, self.robot.settings)
        self._coming: deque[tuple[float, LaserScan, Pose]] = deque()  # [s] when it arrives, and where it was taken
        self._frame_due = self._command_due = 0.0

    def run(self, seconds: float) -> Outcome:
        """Let that much time pass, and tell of it."""
        began = time.perf_counter()
        while self.robot.time < seconds - TICK / 2 and not self.log.watch.over:
            self.tick()
        return self.log.outcome(self.robot.time, time.perf_counter() - began)

    def tick(self) -> None:
        """Let TICK pass."""
        self.robot.step()
        now = self.robot.time
        while self._coming and self._coming[0][0] <= now:
            _, scan, pose = self._coming.popleft()
            self.robot.see(scan)
            self._driver.see(pose, scan)
        if now >= self._command_due:
            self._command_due += COMMAND_PERIOD
            self._drive(now)
        if now >= self._frame_due:
            self._frame_due = now + self.random.uniform(*FRAME_PERIOD)
            scan = self._scan_of(self.robot.frame(), round(now * SECOND))
            self._coming.append((now + self.random.uniform(*AGE), scan, self.robot.pose))
        self.robot.finish()
        robot = self.robot
        self.log.watch.look(Look(robot.time, robot.pose, robot.fallen, robot.bumps, robot.cliff))

    def _drive(self, now: float) -> None:
        self.robot.ask(*self._driver.command(self.robot.pose, self.robot.decision, now))
        self.log.drove(now, self.robot.pose, self.robot.decision, COMMAND_PERIOD)


def outcome_of(case: Case, metres: float) -> Outcome:
    """What comes of a run that lasts as long as a robot that is never held takes for that way [m]."""
    return Trial(case).run(metres / case.speed)


def measure(cases: Sequence[Case], metres: float, jobs: int) -> Iterator[Outcome]:
    """What comes of each run, in their order, the same however many processes share the work; metres as above."""
    return in_order(partial(outcome_of, metres=metres), cases, jobs, lambda: outcome_of(cases[0], 1.0), RENEW)
