"""A simulated robot and the real processes around it, for who drives and watches it from outside."""

import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.topics import VELOCITY, command
from cliffscan.common.runtime.config import SERVICES
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator.kobuki.client import Remote
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint

STEP = 0.02  # [s] between two looks at the processes
STARTING = 60.0  # [s]
SOURCE = "benchmark"
RATE = 10.0  # [Hz] of the frames: two cores keep up


class Interrupted(Exception):
    """The benchmark was told to end."""


class DrivenRobot:
    """A simulated robot whose processes are starting; `ready` waits for them."""

    def __init__(self, system: System, stop: StopSignal) -> None:
        self.system, self._stop = system, stop
        self.remote = Remote(self.folder / "control")

    @property
    def folder(self) -> Path:
        """Where the processes' sockets are."""
        return Path(self.system.plan.folder)

    def ready(self) -> None:
        """Wait until all of it works, and can be driven. Raises TimeoutError, Interrupted."""
        self.wait((self.folder / "control").is_socket, "the simulation")
        self.wait(lambda: self.system.alive.issuperset(SERVICES), "the services")
        self.velocity = self.system.bus.publisher(VELOCITY)

    def wait(self, holds: Callable[[], bool], what: str) -> None:
        """Wait until that holds. Raises TimeoutError, Interrupted."""
        deadline = time.monotonic() + STARTING
        while not holds():
            self.pause()
            if time.monotonic() > deadline:
                raise TimeoutError(f"{what} did not start within {STARTING:.0f} s")

    def pause(self, seconds: float = STEP) -> None:
        """Let some time pass on the clock, and look after the processes. Raises Interrupted."""
        self.system.poll()
        if self._stop.wait(seconds):
            raise Interrupted

    def drive(self, linear: float, angular: float) -> None:
        """Ask for a velocity [m/s, rad/s]."""
        self.velocity.put(Velocity(stamp=time.time_ns(), linear=linear, angular=angular, source=SOURCE))

    def ask(self, name: str) -> None:
        """Have the base do something, as `clear_safety`. Raises RuntimeError where it does not."""
        answer = self.system.bus.ask(command(name), {}, STARTING)
        if not answer or answer.get("ok") is not True:
            raise RuntimeError(f"{name}: {answer}")

    def truth(self) -> dict[str, Any]:
        """The simulation's time [s] and what no sensor tells, as simulator/live.py has it."""
        told: dict[str, Any] = json.loads(self.remote.tell("truth"))
        return told


@contextmanager
def driven_robot(
    name: str, world: str, stop: StopSignal, simulation: Sequence[str] = (), overrides: Sequence[str] = ()
) -> Iterator[DrivenRobot]:
    """A robot whose processes run within the context.

    name: what its robot is called; simulation: options of `python -m simulator`; overrides: SERVICE.KEY=VALUE.
    """
    robot, settings = f"{name}-{os.getpid()}", [f"capture.rate={RATE}", *overrides]
    with System(Plan(robot, [free_endpoint()], overrides=settings, world=world, simulation=simulation), stop) as system:
        yield DrivenRobot(system, stop)
