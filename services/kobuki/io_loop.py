"""Between the network, the base's controller and its port: all that happens, happens in one thread, one after another.

A command, a scan or a request is put in as a job. A turn waits for a job or for bytes of the base, takes in what there
is, and does what is due. So nothing here needs a lock, and a decision always follows from all that came before it.
"""

import math
import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.runtime.command_handlers import Answer, CommandHandler, done, unknown_command
from cliffscan.common.runtime.service import Service
from cliffscan.common.runtime.wakeable_queue import Job, WakeableQueue
from cliffscan.safety.message_gate import TICK
from cliffscan.safety.safety_reports import SafetyReports
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.controller import BaseController
from cliffscan.services.kobuki.port import Port, PortLost
from cliffscan.services.kobuki.publishers import BasePublishers

BEAT = 0.05  # [s] between two heartbeats for the guard
SILENCE = 1.0  # [s] of a silent base after which the service cannot do its work
BACK_OFF = (0.5, 8.0)  # [s] before the first and, doubled each time, before a later attempt to open the port


class IoLoop:
    """The base's side of the network and the network's side of the base."""

    def __init__(self, service: Service[KobukiConfig]) -> None:
        self._service = service
        self._config = service.config
        self._jobs = WakeableQueue()
        self._port: Port | None = None
        self._delay, self._retry_at = BACK_OFF[0], -math.inf
        self._controller = BaseController(service.config, service.metrics.warn_limited)
        self._beaten_at = -math.inf
        self._reports = SafetyReports()
        self._publishers = BasePublishers(service)
        self._safety = service.publisher(topics.SAFETY)
        self._describe = service.bus.latch(topics.DESCRIPTION)

    def listen(self) -> None:
        """Receive commands, scans, the camera's description and requests from now on."""
        bus = self._service.bus
        self._service.receive(topics.VELOCITY, self._on_command)
        self._service.receive_latched(topics.DESCRIPTION, self._on_description)
        self._service.receive(topics.SCAN_FUSED, self._on_scan)
        bus.answer(topics.command("stop"), CommandHandler(self._jobs.put_urgent, self._stop))
        requests = self._controller.requests()
        bus.answer(topics.command("clear_safety"), CommandHandler(self._jobs.put_urgent, requests["clear_safety"]))
        for name in requests.keys() - {"clear_safety"}:
            bus.answer(topics.command(name), CommandHandler(self._put, requests[name]))
        names = ["stop", *requests]
        bus.answer(topics.command("*"), unknown_command(names), except_paths=[*map(topics.command, names)])

    def turn(self) -> None:
        """Take in what comes within a tick, do what is to be done, and what is due."""
        try:
            if self._jobs.wait(self._port, TICK) and self._port:
                self._read(self._port)
            for job in self._jobs.take():
                job()
                self._send()
            self._due(time.monotonic())
            self._send()
            self._report(time.monotonic())
        except PortLost as lost:
            self._lose(str(lost))

    def close(self) -> None:
        """Stop the wheels and let go of the port."""
        if self._port:
            self._port.close()
            self._port = None

    # ---- the port

    def _open(self, now: float) -> None:
        self._port = Port(self._config.port)
        self._controller.connect(self._port.emulated, now)
        self._publishers.begin()
        self._describe(RobotDescription(stamp=time.time_ns(), body=self._config.body(self._port.emulated)))

    def _lose(self, why: str) -> None:
        port, self._port = self._port, None
        if port:
            port.close()
        self._service.metrics.warn_limited("port_lost", f"{why}; trying again in {self._delay:g} s")
        self._service.waiting(why)
        self._retry_at = time.monotonic() + self._delay
        self._delay = min(2 * self._delay, BACK_OFF[1])
        self._controller.disconnect()

    def _read(self, port: Port) -> None:
        for report in self._controller.receive(port.read(), time.time_ns(), time.monotonic()):
            self._send()
            self._publishers.publish(report.feedback, report.core, report.estimate, report.stamp)
        if self._controller.catching_up and not port.has_more():
            self._controller.caught_up()

    def _send(self) -> None:
        """Write what the controller wants to be written."""
        for data, stop in self._controller.take_outputs():
            if not self._port:
                continue
            if stop:
                self._port.stop(data)
            elif not self._port.write(data):
                self._service.metrics.count("line_busy")

    # ---- what comes

    def _put(self, job: Job) -> None:
        if not self._jobs.put(job):
            self._service.metrics.warn_limited("overtaken", "more requests come than can be done")

    def _on_command(self, message: Velocity) -> None:
        def job() -> None:
            self._controller.command(message, time.time_ns(), time.monotonic())

        if not self._jobs.put_newest(f"command of {message.source}", job):
            self._service.metrics.warn_limited("command_refused", "too many sources want to drive")

    def _on_scan(self, scan: LaserScan) -> None:
        self._jobs.put_newest("scan", lambda: self._controller.scan(scan, time.time_ns(), time.monotonic()))

    def _on_description(self, description: RobotDescription) -> None:
        camera = description.camera
        if camera:
            self._jobs.put_newest("camera", lambda: self._controller.describe(camera))

    # ---- what is due

    def _due(self, now: float) -> None:
        """Beat the guard's heart, open a port that is lost, let the controller notice that time passes."""
        if self._port and now - self._beaten_at >= BEAT:
            self._beaten_at = now
            self._port.beat()
        if not self._port and now >= self._retry_at:
            self._open(now)
        self._controller.tick(now)
        self._report_whether_it_works(now)

    def _report_whether_it_works(self, now: float) -> None:
        """The service works while the base is alive and may be driven."""
        controller, service = self._controller, self._service
        if not self._port:
            return
        if now - controller.alive_at > SILENCE:
            why = controller.refused or f"{self._config.port}: the base is silent; is it switched on?"
            if (service.state, service.note) != ("waiting", why):
                service.metrics.warn_limited("silent", why)
                service.waiting(why)
        elif controller.accepted and service.state != "working":
            self._delay = BACK_OFF[0]
            service.ready()

    def _report(self, now: float) -> None:
        """Publish which rule holds, when that changes and once a second."""
        if self._reports.due(self._controller.reasons(now), now):
            self._safety.put(self._controller.safety_state(time.time_ns(), now))

    # ---- what is asked for

    def _stop(self, _: Answer) -> Answer:
        self._controller.stop(time.monotonic())
        return done("stopped until clear_safety")
