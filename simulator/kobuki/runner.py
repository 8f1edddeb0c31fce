"""A base at work on a port: its firmware, its cable and its control socket, coupled."""

import select
import time
from collections.abc import Callable
from pathlib import Path
from typing import Self

from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator.kobuki import control
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.cable import Cable, PathError
from cliffscan.simulator.kobuki.report import Fields, fields
from cliffscan.simulator.kobuki.server import ControlServer

Execute = Callable[[str], str]

LOOK = 0.02  # [s] after which to look, at the latest, whether a driver came


class Runner:
    """Moves bytes between a base and the world. Whoever owns it says how much time has passed.

    A physics simulator calls `exchange` with its own steps; `run` does with the clock's. A simulator that obeys more
    than the base's own commands over the control socket brings its own `execute`.
    """

    def __init__(
        self, base: Base, cable: Cable, server: ControlServer | None = None, execute: Execute | None = None
    ) -> None:
        self.base = base
        self.cable = cable
        self.server = server
        self._execute = execute or (lambda line: control.execute(base, line))

    @classmethod
    def open(cls, base: Base, link: Path, control: Path | None, execute: Execute | None = None) -> Self:
        """A base on a port, with a control socket where a path is given. Raises PathError."""
        server = ControlServer(control) if control else None  # before the port, which another base may have at the link
        try:
            return cls(base, Cable(link), server, execute)
        except PathError:
            if server:
                server.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.cable.close()
        if self.server:
            self.server.close()

    def exchange(self, dt: float) -> None:
        """Let the base live for a while [s], then hear what the driver and the control socket have to say."""
        pieces = self.base.step(dt)
        self._plug()
        if self.cable.plugged:
            self.cable.say(pieces)
            self._hear(dt)
        if self.server:
            self.server.serve(self._execute)
            self._plug()

    @property
    def place(self) -> str:
        """Where it is found, in words."""
        control = f", control at {self.server.path}" if self.server else ""
        return f"{self.cable.link} is {self.cable.device}{control}"

    def wait(self, timeout: float) -> None:
        """Until somebody says something, but not beyond a timeout [s]."""
        files = self.server.files() if self.server else []
        if self.cable.connected:  # a port that nobody has open would never let us sleep
            files.append(self.cable.fileno())
        select.select(files, [], [], timeout)

    def _plug(self) -> None:
        if self.base.plugged and not self.cable.plugged:
            self.cable.plug()
        elif self.cable.plugged and not self.base.plugged:
            self.cable.unplug()
            self._note_connection()

    def _hear(self, dt: float) -> None:
        heard = self.cable.hear(self.base.line.room(dt))
        self._note_connection()
        for command in self.base.receive(heard):
            self._tell(fields(command))

    def _note_connection(self) -> None:
        if self.base.connected != self.cable.connected:
            self.base.connected = self.cable.connected
            self._tell({"port": "opened" if self.base.connected else "closed"})

    def _tell(self, event: Fields) -> None:
        if self.server:
            self.server.tell({"time": self.base.firmware.time, **event})


def run(runner: Runner, stop: StopSignal) -> None:
    """Let the base live by the clock until told to stop."""
    last = time.monotonic()
    while not stop.is_set():
        runner.wait(min(LOOK, runner.base.until_next()))
        now = time.monotonic()
        runner.exchange(now - last)
        last = now
