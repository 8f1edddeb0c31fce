"""One run: a robot in a world, its perception, its base's controller and its driver, as fast as the machine can."""

import logging
import time
from collections import deque
from collections.abc import Iterator, Sequence
from functools import partial
from random import Random

from benchmarks.falls.cases import Case
from benchmarks.falls.driver import Driver
from benchmarks.falls.log import Log, Look, Outcome
from benchmarks.falls.perception import FRAME, perception
from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.controller import BaseController
from cliffscan.services.kobuki.protocol.sensors import Core
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.world import Pose
from evaluation.workers import in_order

SECOND = 1_000_000_000  # [ns]
TICK = 0.01  # [s]
FRAME_PERIOD = (0.07, 0.10)  # [s] between two frames: 10 to 14 Hz
AGE = (0.05, 0.10)  # [s] from a frame to its scan at the gate
COMMAND_PERIOD = 0.05  # [s]
ENCODER_NOISE = 0.003  # [√m] 3 mm after 1 m, on top of how the wheels slip
RENEW = 50  # runs after which a process is replaced

log = logging.getLogger(__name__)


class Trial:
    """A run that goes on for as long as `run` is asked to, or until the robot falls or is stranded."""

    def __init__(self, case: Case) -> None:
        self.random = Random(case.name)
        self.robot = RobotSimulation(case.world, seed=case.seed, wheels=WheelModel(noise=ENCODER_NOISE))
        self.log = Log(case, self.robot.world)
        self._controller = BaseController(KobukiConfig(), lambda what, why: log.debug("%s: %s", what, why))
        self._controller.connect(simulated=True, now=0.0)
        self._controller.describe(CameraDescription.of(self.robot.camera, FRAME, simulated=True))
        self._core: Core | None = None
        self._driver = Driver(tuple(self.log.floor.low), tuple(self.log.floor.high), case.speed, self.random)
        self._scan_of = perception(case.mode, self.robot.camera)
        self._coming: deque[tuple[float, LaserScan, Pose]] = deque()  # [s] when it arrives, and where it was taken
        self._frame_due = self._command_due = 0.0
        self._to_base = b""

    def run(self, seconds: float) -> Outcome:
        """Let that much time pass, and tell of it."""
        began = time.perf_counter()
        while self.robot.time < seconds - TICK / 2 and not self.log.watch.over:
            self.tick()
        return self.log.outcome(self.robot.time, time.perf_counter() - began)

    def tick(self) -> None:
        """Let TICK pass."""
        said = self.robot.step(TICK, self._to_base)
        now = self.robot.time
        for report in self._controller.receive(said, round(now * SECOND), now):
            self._core = report.core
        self._controller.caught_up()
        while self._coming and self._coming[0][0] <= now:
            _, scan, pose = self._coming.popleft()
            self._controller.scan(scan, round(now * SECOND), now)
            self._driver.see(pose, scan)
        if now >= self._command_due:
            self._command_due += COMMAND_PERIOD
            self._drive(now)
        if now >= self._frame_due:
            self._frame_due = now + self.random.uniform(*FRAME_PERIOD)
            scan = self._scan_of(self.robot.frame(), round(now * SECOND))
            self._coming.append((now + self.random.uniform(*AGE), scan, self.robot.pose))
        self._controller.tick(now)
        self._to_base = b"".join(output.data for output in self._controller.take_outputs())
        self.log.watch.look(self._look())

    def _drive(self, now: float) -> None:
        asked = self._driver.command(self.robot.pose, self._controller.decision, now)
        stamp = round(now * SECOND)
        self._controller.command(Velocity(stamp=stamp, linear=asked[0], angular=asked[1]), stamp, now)
        self.log.drove(now, self.robot.pose, self._controller.decision, COMMAND_PERIOD)

    def _look(self) -> Look:
        robot, core = self.robot, self._core
        return Look(robot.time, robot.pose, robot.fallen, robot.base.bumps, bool(core and core.cliff))


def outcome_of(case: Case, metres: float) -> Outcome:
    """What comes of a run that lasts as long as a robot that is never held takes for that way [m]."""
    return Trial(case).run(metres / case.speed)


def measure(cases: Sequence[Case], metres: float, jobs: int) -> Iterator[Outcome]:
    """What comes of each run, in their order, the same however many processes share the work; metres as above."""
    return in_order(partial(outcome_of, metres=metres), cases, jobs, lambda: outcome_of(cases[0], 1.0), RENEW)
