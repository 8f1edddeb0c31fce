"""Runs through the real processes: the same worlds, driver and reckoning, at the clock's pace."""

import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from random import Random

from benchmarks.falls.bases import ENCODER_NOISE, TURTLEBOT_2_SIZE
from benchmarks.falls.cases import Case
from benchmarks.falls.driver import Driver
from benchmarks.falls.log import Log, Look, Outcome
from benchmarks.falls.trial import COMMAND_PERIOD
from cliffscan.common.contract.base_messages import BaseState, Odometry, Rule, SafetyState
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import BASE_STATE, ODOMETRY, SAFETY, SCAN_FUSED
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.safety.inputs import REST, Twist
from cliffscan.safety.rules import Decision
from cliffscan.simulator.world import Pose, World
from evaluation.processes.driven import DrivenRobot, Interrupted, driven_robot
from evaluation.processes.service_log import ServiceLog
from evaluation.processes.truth_feed import TruthFeed

OVERRIDES = {"default": (), "paper": ("profile=paper",)}  # by mode; positive alone is nothing that `fuse` says


class ProcessTrial:
    """A run that goes on for as long as `run` is asked to, until the robot falls or is stranded, or it is told to end.

    Raises KeyError for a mode that the processes do not have.
    """

    def __init__(self, case: Case, stop: StopSignal) -> None:
        random = Random(case.name)
        self.log = Log(case, World(case.world), TURTLEBOT_2_SIZE)
        floor = self.log.floor
        self._driver = Driver(tuple(floor.low), tuple(floor.high), case.speed, random, TURTLEBOT_2_SIZE)
        self._rule: Rule = "no_base"
        self._speed = REST  # by the base's odometry: how much of a command is allowed is not told as often
        self._cliff = False  # since the last look
        self._scans: LatestQueue[LaserScan] = LatestQueue()
        wheels = ["--slip-noise", str(ENCODER_NOISE)]
        self._robot = driven_robot("falls", case.world, stop, wheels, OVERRIDES[case.mode])

    def run(self, seconds: float) -> Outcome:
        """Start the processes, let that much time [s] of the simulation pass, end them.

        Raises TimeoutError, Interrupted.
        """
        with self._robot as robot:
            robot.ready()
            bus = robot.system.bus
            bus.subscribe(SAFETY.path, lambda _, payload: self._decided(SafetyState.decode(payload)))
            bus.subscribe(ODOMETRY.path, lambda _, payload: self._moved(Odometry.decode(payload)))
            bus.subscribe(BASE_STATE.path, lambda _, payload: self._felt(BaseState.decode(payload)))
            bus.subscribe(SCAN_FUSED.path, lambda _, payload: self._scans.put(LaserScan.decode(payload)))
            feed = TruthFeed(str(robot.folder / "frames"))
            try:
                return self._drive(robot, feed, seconds)
            finally:
                feed.close()

    def _drive(self, robot: DrivenRobot, feed: TruthFeed, seconds: float) -> Outcome:
        began, start = time.perf_counter(), robot.truth()["time"]
        now, asked = 0.0, REST
        while now < seconds and not self.log.watch.over:
            robot.pause(COMMAND_PERIOD)
            told = robot.truth()
            passed, now, pose = told["time"] - start - now, told["time"] - start, Pose(*told["pose"])
            scan = self._scans.get(timeout=0.0)
            if scan and (seen := feed.by_stamp.get(scan.stamp)):
                self._driver.see(seen.pose, scan)
            decision = Decision(self._rule, self._speed, asked)
            asked = self._driver.command(pose, decision, now)
            robot.drive(*asked)
            self.log.drove(now, pose, decision, passed)
            self.log.watch.look(Look(now, pose, told["fallen"], told["bumps"], self._cliff))
            self._cliff = False
        return self.log.outcome(now, time.perf_counter() - began)

    def _decided(self, state: SafetyState) -> None:
        self._rule = state.rule

    def _moved(self, odometry: Odometry) -> None:
        self._speed = Twist(*odometry.twist)

    def _felt(self, state: BaseState) -> None:
        self._cliff |= any(state.cliffs)


def through_processes(cases: Sequence[Case], metres: float, out: Path) -> Iterator[Outcome]:
    """What comes of each run, until told to end; metres as for trial.measure, out: folder for what the services log.

    Raises KeyError for a mode that the processes do not have, TimeoutError where they do not start.
    """
    stop = StopSignal()
    with suppress(Interrupted):
        for case in cases:
            log = out / f"{case.file_name}.log"
            log.write_text("")
            with ServiceLog(log):
                outcome = ProcessTrial(case, stop).run(metres / case.speed)
            yield outcome
