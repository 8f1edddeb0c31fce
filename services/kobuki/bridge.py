"""Between the network and the base: all that happens, happens in one thread, one thing after another.

A command, a scan or a request is put in as a job. A turn waits for a job or for bytes of the base, takes in what there
is, and does what is due. So nothing here needs a lock, and a decision always follows from all that came before it.
"""

from __future__ import annotations

import math
import time
from concurrent.futures import Future

from common import topics
from common.base_messages import Velocity
from common.messages import LaserScan
from common.service import Service
from services.kobuki import commands, reports
from services.kobuki.config import KobukiConfig
from services.kobuki.desk import Answer, Desk, GainsDesk, Reply, done, failed, no_desk
from services.kobuki.frames import FrameParser
from services.kobuki.ground import Pose
from services.kobuki.handshake import Handshake
from services.kobuki.history import PoseHistory
from services.kobuki.jobs import Job, Jobs
from services.kobuki.news import News
from services.kobuki.odometry import Odometry
from services.kobuki.outlets import Outlets
from services.kobuki.packets import Feedback, decode
from services.kobuki.port import Port, PortLost
from services.kobuki.safety import Decision, Safety, Scan, Twist
from services.kobuki.versions import has_gains

TICK = 0.03  # [s] between decisions when the base is silent; it is not while it sends its packet every 0.02 s
BEAT = 0.05  # [s] between two heartbeats for the guard
SILENT = 0.5  # [s] without news of the base
REPORT = 1.0  # [s] between two reports of an unchanged rule
BACK_OFF = (0.5, 8.0)  # [s] before the first and, doubled each time, before a later attempt to open the port


class Bridge:
    """The base's side of the network and the network's side of the base."""

    def __init__(self, service: Service[KobukiConfig]) -> None:
        self._service = service
        self._config = service.config
        self._jobs = Jobs()
        self._port: Port | None = None
        self._delay, self._retry_at = BACK_OFF[0], -math.inf
        self._odometry = Odometry()  # for the world, which may reset it
        self._origin = Pose(0.0, 0.0, 0.0)  # where it was reset, in the gate's frame, which never jumps
        self._history = PoseHistory()
        self._safety = Safety(service.config, Pose(0.0, 0.0, 0.0))
        self._outlets = Outlets(self._write)
        self._gains = GainsDesk(self._write)
        self._decided_at = self._reported_at = self._beaten_at = -math.inf
        self._reported: tuple[object, ...] = ()
        self._catching_up = False  # with what the base said while nobody listened
        self._news = News(service)
        self._begin()
        self._said = service.publisher(topics.SAFETY)

    def listen(self) -> None:
        """Hear commands, scans and requests from now on."""
        self._service.receive(topics.VELOCITY, lambda message: self._put(lambda: self._command(message)))
        self._service.receive(topics.SCAN_FUSED, lambda message: self._put(lambda: self._scan(message)))
        replies: dict[str, Reply] = {
            "stop": self._stop,
            "clear_safety": self._clear,
            "reset_odometry": self._reset,
            "led": self._outlets.led,
            "sound": self._outlets.sound,
            "digital_output": self._outlets.digital_output,
            "gains": self._ask_gains,
            "version": lambda _: self._handshake.told(),
        }
        for name, reply in replies.items():
            self._service.bus.answer(topics.command(name), Desk(self._put, reply))
        self._service.bus.answer(topics.command("*"), no_desk(replies), but_at=[*map(topics.command, replies)])

    def turn(self) -> None:
        """Take in what comes within a tick, do the next job, and what is due."""
        try:
            if self._jobs.wait(self._port, TICK) and self._port:
                self._bytes(self._port.read())
                self._catching_up = self._catching_up and self._port.has_more()
            if job := self._jobs.take():
                job()
            self._due(time.monotonic())
        except PortLost as lost:
            self._lose(str(lost))

    def close(self) -> None:
        """Stop the wheels and let go of the port."""
        if self._port:
            try:
                self._port.write(commands.base_control(0.0, 0.0))
            except PortLost as lost:
                self._service.tally.complain("port_lost", str(lost))
            self._port.close()
            self._port = None

    # ---- the port

    def _begin(self) -> None:
        """Know nothing of the base."""
        self._parser, self._handshake = FrameParser(), Handshake()
        self._news.begin()
        self._heard_at = -math.inf

    def _open(self, now: float) -> None:
        self._begin()
        self._port = Port(self._config.port)
        self._heard_at = now

    def _lose(self, why: str) -> None:
        port, self._port = self._port, None
        if port:
            port.close()
        self._service.tally.complain("port_lost", f"{why}; trying again in {self._delay:g} s")
        self._service.state, self._service.note = "waiting", why
        self._retry_at = time.monotonic() + self._delay
        self._delay = min(2 * self._delay, BACK_OFF[1])
        self._safety.lose_base()
        self._odometry.rebaseline("the port was opened anew")

    def _write(self, data: bytes) -> None:
        if not self._port or not self._handshake.accepted:
            raise PortLost("the base is not connected")
        self._port.write(data)

    # ---- what comes

    def _put(self, job: Job) -> None:
        if not self._jobs.put(job):
            self._service.tally.complain("overtaken", "more comes than can be done")

    def _bytes(self, data: bytes) -> None:
        bad = self._parser.counts.bad_checksums
        for payload in self._parser.feed(data):
            self._packet(decode(payload), time.time_ns(), time.monotonic())
        for _ in range(self._parser.counts.bad_checksums - bad):
            self._service.tally.complain("bad_packet", "the base sent a packet with a wrong checksum")

    def _packet(self, feedback: Feedback, stamp: int, now: float) -> None:
        for skipped in feedback.skipped:
            self._service.tally.complain("bad_sub_payload", str(skipped))
        if self._handshake.hear(feedback):
            self._accept()
        if feedback.gains:
            self._gains.told(feedback.gains)
        if feedback.core is None or not self._handshake.accepted:
            return
        self._heard_at = now
        estimate = self._odometry.update(feedback.core, feedback.inertia, now)
        pose = self._origin.then(Pose(*estimate.pose))
        if estimate.new_baseline:
            self._service.tally.complain("baseline", estimate.new_baseline)
            self._catching_up = True
        if self._catching_up:  # what is read late tells where the robot was; it begins anew where it is
            self._safety.restart(pose)
        self._history.add(stamp, pose)
        self._safety.sense(feedback.core, pose)
        self._decide(now)
        self._news.tell(feedback, feedback.core, estimate, stamp)

    def _accept(self) -> None:
        """The base told its firmware."""
        if self._handshake.refused:
            self._service.state, self._service.note = "waiting", self._handshake.refused
            self._service.tally.complain("refused", self._handshake.refused)
        else:
            self._delay = BACK_OFF[0]
            self._outlets.resend()
            self._service.ready()

    def _command(self, message: Velocity) -> None:
        self._safety.command(Twist(message.linear, message.angular), time.monotonic())
        self._decide(time.monotonic())

    def _scan(self, scan: LaserScan) -> None:
        now = time.monotonic()
        pose = self._history.at(scan.stamp)
        if pose is None:
            if self._history.full:
                self._service.tally.complain("scan_unplaced", f"stamp {scan.stamp}: not known where the robot was then")
            else:  # it is older than the odometry, which has begun just now or not yet
                self._service.tally.count("scan_unplaced")
            return
        taken = now - (time.time_ns() - scan.stamp) * 1e-9
        self._safety.see(Scan.of(scan), pose, taken, now)

    # ---- what goes

    def _due(self, now: float) -> None:
        if self._port:
            self._look_after(self._port, now)
        elif now >= self._retry_at:
            self._open(now)
        if now - self._decided_at >= TICK:
            self._decide(now)

    def _look_after(self, port: Port, now: float) -> None:
        """Beat the guard's heart, notice a silent base, ask what is not answered yet."""
        if now - self._beaten_at >= BEAT:
            self._beaten_at = now
            port.beat()
        if now - self._heard_at > SILENT:
            self._safety.lose_base()
        if self._parser.counts.good and (request := self._handshake.request(now)):
            port.write(request)

    def _decide(self, now: float) -> None:
        """Ask the gate, and tell the wheels and the world."""
        self._decided_at = now
        decision = self._safety.decide(now)
        if self._handshake.refused:
            decision = Decision("refused", Twist(0.0, 0.0), decision.asked, note=self._handshake.refused)
        elif self._port and self._handshake.accepted:
            self._port.write(commands.base_control(*decision.allowed))
        self._tell(decision, now)

    def _tell(self, decision: Decision, now: float) -> None:
        latched = bool(self._safety.latched)
        news = (decision.rule, latched, decision.note if decision.rule != "no_scan" else "")
        if news != self._reported or now - self._reported_at >= REPORT:
            self._reported, self._reported_at = news, now
            self._said.put(reports.safety(decision, latched, time.time_ns()))

    # ---- what is asked for

    def _stop(self, _: Answer) -> Answer:
        self._safety.stop("asked to")
        self._decide(time.monotonic())
        return done("stopped until clear_safety")

    def _ask_gains(self, parameters: Answer) -> Answer | Future[Answer]:
        firmware = self._handshake.firmware
        if firmware and not has_gains(firmware):
            return failed(f"firmware {firmware} has no gains to tell")
        return self._gains.request(parameters)

    def _clear(self, _: Answer) -> Answer:
        self._safety.clear()
        return done("cleared")

    def _reset(self, _: Answer) -> Answer:
        self._origin = self._origin.then(Pose(*self._odometry.pose))
        self._odometry.reset()
        return done("here is the origin")
