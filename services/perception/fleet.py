"""The robots that perception serves: those that are named, or every one that publishes depth images."""

import logging
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any

from cliffscan.common.contract import topics
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.common.runtime.bus import EVERY, Bus
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.pace import Pace
from cliffscan.common.runtime.service import PATIENCE, RATE, StopSignal, package_version
from cliffscan.services.negative.scans import compile_kernels
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.perception.robot import RobotPerception
from cliffscan.services.perception.turns import MOST, Turns

SILENCE = 10.0  # [s] after which a robot that nobody named is served no more
BURST = 32  # samples that may wait to be sorted; and so many of one robot may come at once

log = logging.getLogger(__name__)


class Fleet:
    """Serves robots in turn, each by the newest of its depth images.

    A robot that nobody named is served from its first good depth image on, until it has been silent for SILENCE.
    """

    def __init__(self, bus: Bus, names: Sequence[str] | None, configs: Mapping[str, Any], stop: StopSignal) -> None:
        """names: of the robots to serve; None for every one."""
        self._bus = bus
        self._names = names
        self._configs = configs
        self._stop = stop
        self._turns = Turns()
        self._strangers = ServiceMetrics()  # of robots that are not served
        self._paces: dict[str, Pace] = {}
        self._lock = threading.Lock()  # over the two below, of which the statuses are published from another thread
        self._robots: dict[str, RobotPerception] = {}
        self._seen: dict[str, float] = {}  # [s], when each robot that nobody named last had a turn

    def serve(self) -> None:
        """Answer depth images until the process is told to end."""
        compile_kernels(self._configs["negative"])
        perceive(WARMUP_IMAGE, Settings(self._configs["negative"], self._configs["positive"]))
        for name in self._names or ():
            self._add(name)
        for name in [EVERY] if self._names is None else self._names:
            self._bus.beside(name).subscribe_robots(
                topics.DEPTH.path, self._arrived, BURST, self._wanted, self._refused
            )
        self._stop.patient = True
        for robot in self._robots.values():
            robot.announce()
        log.info("ready for %s, version %s", ", ".join(self._names or ["every robot"]), package_version())
        while not self._stop.is_set():
            turn = self._turns.take(PATIENCE)
            if turn:
                began = time.monotonic()
                self._take(*turn)
                self._turns.spent(turn[0], time.monotonic() - began)
            self._leave_silent()

    def publish_statuses(self) -> None:
        """Publish how every robot fares."""
        with self._lock:
            for robot in self._robots.values():
                robot.publish_statuses()

    def _wanted(self, name: str) -> bool:
        """Whether there is room for a sample of a robot, of which no more than RATE are taken."""
        now = time.monotonic()
        pace = self._paces.setdefault(name, Pace(RATE, BURST))
        if len(self._paces) > 2 * MOST:
            self._paces = {name: pace}
        if pace.delay(now) > 0.0 or not self._turns.admits(name):
            return False
        pace.spend(now)
        return True

    def _arrived(self, name: str, payload: bytes) -> None:
        if not self._turns.put(name, payload) and (robot := self._robots.get(name)):
            robot.overtaken()

    def _refused(self, name: str, why: MessageError) -> None:
        robot = self._robots.get(name)
        if robot:
            robot.refused(why)
        else:
            self._strangers.warn_limited("malformed", f"{topics.DEPTH.key(name)}: {why}")

    def _take(self, name: str, payloads: Sequence[bytes]) -> None:
        robot = self._robots.get(name) or self._discovered(name, payloads)
        if not robot:
            return
        robot.take(payloads)
        if name in self._seen:
            self._seen[name] = time.monotonic()

    def _discovered(self, name: str, payloads: Sequence[bytes]) -> RobotPerception | None:
        """A robot that publishes a good depth image for the first time; None where it does not, or there is no room."""
        faults = [_fault(payload) for payload in payloads]
        if None not in faults:
            for fault in filter(None, faults):
                self._refused(name, fault)
            return None
        if len(self._robots) >= MOST:
            self._strangers.warn_limited("too_many", f"{name}: {MOST} robots are served already; start another process")
            return None
        robot = self._add(name)
        self._seen[name] = time.monotonic()
        robot.announce()
        log.info("serves %s", name)
        return robot

    def _add(self, name: str) -> RobotPerception:
        robot = RobotPerception(self._bus, name, self._configs, self._stop)
        with self._lock:
            self._robots[name] = robot
        return robot

    def _leave_silent(self) -> None:
        """Take back what was declared for robots that have been silent for too long."""
        now = time.monotonic()
        for name in [name for name, at in self._seen.items() if now - at > SILENCE]:
            with self._lock:
                del self._seen[name]
                self._robots.pop(name).retract()
            log.info("%s is silent", name)


def _fault(payload: bytes) -> MessageError | None:
    """Why a payload is no depth image; None where it is one."""
    try:
        DepthImage.decode(payload)
    except MessageError as error:
        return error
    return None
