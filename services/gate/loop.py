"""Between the network and the gate: all that happens, happens in one thread, one after another.

A message or a request is put in as a job. So nothing here needs a lock, and a decision always follows from all that
came before it.
"""

import time
from collections.abc import Callable
from typing import TypeVar

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import BaseState, Velocity
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.message import Message
from cliffscan.common.runtime.command_handlers import Answer, CommandHandler, done, unknown_command
from cliffscan.common.runtime.service import Service
from cliffscan.common.runtime.wakeable_queue import WakeableQueue
from cliffscan.safety.inputs import REST, Twist
from cliffscan.safety.message_gate import TICK
from cliffscan.safety.safety_reports import SafetyReports
from cliffscan.services.gate.config import GateConfig
from cliffscan.services.gate.controller import GateController

M = TypeVar("M", bound=Message)

SOURCE = "gate"
SILENCE = 1.0  # [s] without odometry after which the status says so
SILENT_BASE = f"no odometry comes on {topics.ODOMETRY.path}: does the base's driver run, by a synchronised clock?"


class GateLoop:
    """The base's side of the network and the network's side of the base."""

    def __init__(self, service: Service[GateConfig]) -> None:
        self._service = service
        self._jobs = WakeableQueue()
        self._controller = GateController(service.config, service.metrics.warn_limited)
        self._reports = SafetyReports()
        self._safety = service.publisher(topics.SAFETY)
        self._velocity = service.publisher(topics.VELOCITY_SAFE)
        self._describe = service.bus.latch(topics.DESCRIPTION)

    def listen(self) -> None:
        """Describe the body, and receive all that the gate needs from now on."""
        service, controller = self._service, self._controller
        body = service.config.body(service.config.simulated)
        self._describe(RobotDescription(stamp=time.time_ns(), body=body))
        service.receive(topics.VELOCITY, self._on_command)
        self._receive(topics.ODOMETRY, controller.odometry)
        service.receive(topics.BASE_STATE, self._on_state)
        service.receive_latched(topics.DESCRIPTION, self._on_description)
        self._receive(topics.SCAN_FUSED, controller.scan)
        requests = {"stop": self._stop, "clear_safety": self._clear}
        for name, reply in requests.items():
            service.bus.answer(topics.command(name), CommandHandler(self._jobs.put_urgent, reply))
        paths = [topics.command(name) for name in requests]
        service.bus.answer(topics.command("*"), unknown_command(requests), except_paths=paths)

    def turn(self) -> None:
        """Take in what comes within a tick, do what is to be done, and publish what follows."""
        self._jobs.wait(None, TICK)
        for job in self._jobs.take():
            job()
            self._publish()
        now = time.monotonic()
        self._controller.tick(now)
        self._publish()
        if self._reports.due(self._controller.reasons(now), now):
            self._safety.put(self._controller.safety_state(time.time_ns(), now))
        silent = now - self._controller.alive_at > SILENCE
        self._service.note = SILENT_BASE if silent else ""

    def close(self) -> None:
        """The last word: the base shall stand."""
        self._put(REST)

    def _publish(self) -> None:
        for velocity in self._controller.take_outputs():
            self._put(velocity)

    def _put(self, velocity: Twist) -> None:
        stamp = time.time_ns()
        self._velocity.put(Velocity(stamp=stamp, linear=velocity.linear, angular=velocity.angular, source=SOURCE))
        self._service.metrics.output(stamp)

    # ---- what comes

    def _receive(self, topic: topics.Topic[M], take: Callable[[M, int, float], None]) -> None:
        """Have `take(message, stamp, now)` called for the newest message of a topic."""

        def arrived(message: M) -> None:
            self._jobs.put_newest(topic.path, lambda: take(message, time.time_ns(), time.monotonic()))

        self._service.receive(topic, arrived)

    def _on_command(self, message: Velocity) -> None:
        def job() -> None:
            self._controller.command(message, time.time_ns(), time.monotonic())

        if not self._jobs.put_newest(f"command of {message.source}", job):
            self._service.metrics.warn_limited("command_refused", "too many sources want to drive")

    def _on_state(self, message: BaseState) -> None:
        """Each counts, for a contact may be in one of them only."""
        self._jobs.put(lambda: self._controller.state(message, time.time_ns(), time.monotonic()))

    def _on_description(self, description: RobotDescription) -> None:
        camera = description.camera
        if camera:
            self._jobs.put_newest("camera", lambda: self._controller.describe(camera))

    # ---- what is asked for

    def _stop(self, _: Answer) -> Answer:
        self._controller.stop(time.monotonic())
        return done("stopped until clear_safety")

    def _clear(self, _: Answer) -> Answer:
        self._controller.clear()
        return done("cleared")
