"""The robots that perception serves: those that are named, or its share of all that publish depth images."""

import logging
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from cliffscan.common.contract import topics
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, ServiceStatus
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.common.runtime.alive_file import mark_alive
from cliffscan.common.runtime.bus import EVERY, Bus
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.pace import Pace
from cliffscan.common.runtime.service import PATIENCE, RATE, package_version
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.negative.scans import compile_kernels
from cliffscan.services.perception.admission import Admission
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.perception.robot import NAME, RobotPerception
from cliffscan.services.perception.standing import CLAIM, MOST, Standing, Standings
from cliffscan.services.perception.turns import Turns

SILENCE = 10.0  # [s] after which a robot that nobody named is served no more
BURST = 32  # samples that may wait to be sorted; and so many of one robot may come at once
KNOWN = 1024  # robots that may be known, whichever process serves them
SINGLE = ("negative", "positive", "fuse")  # services that serve one robot, and go before this process

log = logging.getLogger(__name__)


class Fleet:
    """Serves robots in turn, each by the newest of its depth images, as far as no other process does.

    A robot that nobody named is served from its first good depth image on, until it has been silent for SILENCE.
    """

    def __init__(self, bus: Bus, names: Sequence[str] | None, configs: Mapping[str, Any], stop: StopSignal) -> None:
        """names: of the robots to serve; None for every one."""
        now = time.monotonic()
        self._bus = bus
        self._names = names
        self._configs = configs
        self._stop = stop
        self._me = uuid.uuid4().hex[:8]
        self._turns = Turns()
        self._admission = Admission(now)
        self._metrics = ServiceMetrics()  # of what belongs to no robot that is served
        self._paces: dict[str, Pace] = {}
        self._standings = Standings(self._me, names, now)
        self._news: deque[Callable[[], object]] = deque()  # of other processes, for the thread that serves
        self._reviewed = now
        self._claims: dict[str, Bus] = {}  # with the token of each robot that is claimed
        self._published: dict[str, float] = {}  # [s], when each robot that nobody named last published
        self._first: dict[str, bytes] = {}  # the newest image of each robot that is soon served first
        self._lock = threading.Lock()  # over the robots, of which the statuses are published from another thread
        self._robots: dict[str, RobotPerception] = {}

    def serve(self) -> None:
        """Answer depth images until the process is told to end."""
        compile_kernels(self._configs["negative"])
        perceive(WARMUP_IMAGE, Settings(self._configs["negative"], self._configs["positive"]))
        self._subscribe()
        self._stop.patient = True
        mark_alive(True)
        log.info("ready for %s, version %s", ", ".join(self._names or ["every robot"]), package_version())
        while not self._stop.is_set():
            turn = self._turns.take(PATIENCE)
            if turn:
                began = time.monotonic()
                self._take(*turn)
                spent = time.monotonic() - began
                self._turns.spent(spent)
                self._admission.worked(turn[0], spent)
            self._review()

    def publish_statuses(self) -> None:
        """Publish how every robot fares."""
        with self._lock:
            for robot in self._robots.values():
                robot.publish_statuses()

    def _subscribe(self) -> None:
        """Receive what robots and other processes publish; then be one of the fleet, where every robot is served."""
        standings = self._standings
        self._bus.watch_members(NAME, lambda *news: self._news.append(partial(standings.member, *news)))
        for name in [EVERY] if self._names is None else self._names:
            bus = self._bus.beside(name)
            bus.watch_robots(lambda *news: self._news.append(partial(standings.token, *news)))
            bus.subscribe_robots(topics.DEPTH.path, self._arrived, BURST, self._wanted, self._refused)
            for service in SINGLE:
                path, heard = topics.STATUS.named(service).path, partial(self._status_of, service)
                bus.subscribe_robots(path, heard, BURST, self._serves, _nothing, of_others=True)
        if self._names is None:
            self._bus.join(NAME, self._me)

    def _serves(self, robot: str) -> bool:
        return robot in self._robots

    def _status_of(self, service: str, robot: str, payload: bytes) -> None:
        """Another process published its status as one of SINGLE. While it only starts, it makes no scans."""
        try:
            works = ServiceStatus.decode(payload).state == "working"
        except MessageError:
            return
        if works:
            self._news.append(partial(self._yield, service, robot))

    def _yield(self, service: str, robot: str) -> None:
        if self._standings.status(robot, time.monotonic()):
            self._metrics.warn_limited("yielded", f"{robot}: another {service} serves it, and goes before this process")

    def _wanted(self, name: str) -> bool:
        """Whether a sample of a robot is looked at: there is room, its rate is none of a flood, and it is served here.

        Of a robot that is not known yet a sample is looked at, too, and of one that is new and soon to be served.
        """
        now = time.monotonic()
        pace = self._paces.setdefault(name, Pace(RATE, BURST))
        if len(self._paces) > 2 * KNOWN:
            self._paces = {name: pace}
        if pace.delay(now) > 0.0 or not self._turns.admits(name, self._is_known(name)):
            return False
        pace.spend(now)
        robot = self._robots.get(name)
        if robot is None:
            return not self._knows(name, now) or self._standings.is_new(name)
        if name in self._published:
            self._published[name] = now
        taken = self._admission.takes(name, self._turns.is_idle())
        if not taken:
            robot.not_taken()
        return taken

    def _knows(self, name: str, now: float) -> bool:
        """Whether a robot that nobody named publishes good images, which it does now."""
        if name in self._published:
            self._published[name] = now
        return self._is_known(name)

    def _is_known(self, name: str) -> bool:
        """Whether a robot was named, or has published a good image."""
        return name in self._published or self._names is not None

    def _arrived(self, name: str, payload: bytes) -> None:
        if self._turns.put(name, payload, self._is_known(name)):
            return
        self._admission.overtaken(name)
        if robot := self._robots.get(name):
            robot.overtaken()

    def _refused(self, name: str, why: MessageError) -> None:
        robot = self._robots.get(name)
        if robot:
            robot.refused(why)
        else:
            self._metrics.warn_limited("malformed", f"{topics.DEPTH.key(name)}: {why}")

    def _take(self, name: str, payloads: Sequence[bytes]) -> None:
        robot = self._robots.get(name)
        if robot:
            robot.take(payloads)
        elif self._is_good(name, payloads) and self._is_soon_served(name):
            self._keep(name, payloads[-1])

    def _is_soon_served(self, name: str) -> bool:
        """Whether a robot that is not served may be soon, as the first time."""
        return self._standings.is_new(name) and name not in self._standings.beyond

    def _keep(self, name: str, payload: bytes) -> None:
        """Keep a robot's newest image until it is served; of MOST robots, for no more are served."""
        self._first.pop(name, None)
        self._first[name] = payload
        if len(self._first) > MOST:
            del self._first[next(iter(self._first))]

    def _is_good(self, name: str, payloads: Sequence[bytes]) -> bool:
        """Whether a robot that is not served publishes good depth images; it is known then."""
        if self._knows(name, time.monotonic()):
            return True
        faults = [_fault(payload) for payload in payloads]
        if None not in faults:
            for fault in filter(None, faults):
                self._refused(name, fault)
            return False
        if len(self._published) >= KNOWN:
            self._metrics.warn_limited("too_many", f"{name}: {KNOWN} robots are known already")
            return False
        self._published[name] = time.monotonic()
        return True

    def _review(self) -> None:
        """Now and then, and when something is new: see which robots are to be served, and how many of their frames."""
        now = time.monotonic()
        if self._admission.review(now):
            self._limit()
        if not self._news and now - self._reviewed < PATIENCE / 2:
            return
        self._reviewed = now
        while self._news:
            self._news.popleft()()
        for name in [name for name, at in self._published.items() if now - at > SILENCE]:
            del self._published[name]
            self._first.pop(name, None)
            self._standings.forget(name)
        for name, standing in self._standings.review(self._published.keys(), now).items():
            self._become(name, standing)
        self._first = {name: image for name, image in self._first.items() if self._is_soon_served(name)}
        for name in self._standings.beyond:
            why = f"{name}: {MOST} robots are served already; start another process"
            self._metrics.warn_limited("too_many", why)

    def _become(self, name: str, standing: Standing) -> None:
        """Hold the token of a claim, serve, or leave a robot."""
        if standing is not Standing.SERVES and name in self._robots:
            self._leave(name)
        if standing is Standing.AWAY:
            self._claims.pop(name).withdraw()
        elif name not in self._claims:
            self._claims[name] = self._bus.beside(name)
            self._claims[name].announce(f"{CLAIM}{self._me}")
        if standing is Standing.SERVES:
            self._begin(name)

    def _begin(self, name: str) -> None:
        robot = RobotPerception(self._bus, name, self._configs, self._stop)
        with self._lock:
            self._robots[name] = robot
        robot.announce()
        log.info("serves %s", name)
        first = self._first.pop(name, None)
        if first and self._standings.is_new(name):  # still: else whoever served it has answered this image
            robot.take([first])

    def _leave(self, name: str) -> None:
        with self._lock:
            robot = self._robots.pop(name)
        self._turns.drop(name)
        robot.retract()
        log.info("leaves %s", name)

    def _limit(self) -> None:
        """Say of which robots not all frames are taken."""
        shares = self._admission.shares
        for name, robot in self._robots.items():
            share = shares.get(name)
            robot.limited = f"{share.taken:.0f} of {share.offered:.0f} frames a second are taken" if share else ""
        if shares:
            each = ", ".join(f"{name} {share.taken:.0f} of {share.offered:.0f}" for name, share in shares.items())
            self._metrics.warn_limited(
                "overloaded", f"frames a second that are taken: {each}; serve some by another process"
            )


def _nothing(*_: object) -> None:
    """What is looked at nowhere else needs no work."""


def _fault(payload: bytes) -> MessageError | None:
    """Why a payload is no depth image; None where it is one."""
    try:
        DepthImage.decode(payload)
    except MessageError as error:
        return error
    return None
