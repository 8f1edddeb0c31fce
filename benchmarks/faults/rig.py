"""The real processes in a simulated world, driven and watched."""

from __future__ import annotations

import json
import os
import random
import signal
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import NamedTuple, Self

from benchmarks.faults.frame_relay import FrameRelay
from benchmarks.faults.shuttle import START, WORLD, Shuttle
from cliffscan.system import Plan, System
from common.base_messages import Velocity
from common.config import SERVICES
from common.service import StopSignal
from common.topics import VELOCITY
from experiments.collect import free_port
from simulator.kobuki.client import Remote
from simulator.world import Pose

STEP = 0.02  # [s] between two looks
STARTING = 60.0  # [s]
TURNING, ONCE = 0.6, 13.0  # [rad/s], [s]
RATE = 10.0  # [Hz] of the frames


class Interrupted(Exception):
    """The benchmark was told to end."""


class Sample(NamedTuple):
    """The robot at one moment of the simulation."""

    time: float  # [s]
    pose: Pose
    speed: float  # [m/s] of the middle between the wheels, backward too
    fallen: bool


class Rig:
    """A context manager: entering starts everything. `step` is to be called again and again, for it also drives."""

    def __init__(self, stop: StopSignal, rng: random.Random) -> None:
        self.quiet = False  # the driver says nothing
        self._turning = False
        self._stop = stop
        self._shuttle = Shuttle(rng)
        self._exit = ExitStack()

    def __enter__(self) -> Self:
        with ExitStack() as entered:
            folder = Path(entered.enter_context(TemporaryDirectory(prefix="faults-")))
            start = [*map(str, START[:2]), "0"]
            options = ["--frames", f"{folder}/frames", "--start", *start]
            listen = [f"tcp/127.0.0.1:{free_port()}"]
            plan = Plan(
                f"faults-{os.getpid()}", listen, overrides=[f"capture.rate={RATE}"], world=WORLD, simulation=options
            )
            self.system = entered.enter_context(System(plan, self._stop))
            here = Path(self.system.plan.folder)
            self.remote = Remote(here / "control")
            self._wait(lambda: (folder / "frames").is_socket() and (here / "control").is_socket(), "the simulation")
            self.relay = FrameRelay(f"{folder}/frames", f"{here}/frames")
            entered.callback(self.relay.close)
            self._velocity = self.system.bus.publisher(VELOCITY)
            self._wait(lambda: self.system.alive.issuperset(SERVICES), "the services")
            self._exit = entered.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._exit.close()

    @property
    def speed(self) -> float:
        """How fast the driver wants to go [m/s]."""
        return self._shuttle.speed

    def step(self) -> Sample:
        """Look after the processes, look where the robot is, and drive on. Raises Interrupted."""
        self.system.poll()
        if self._stop.wait(STEP):
            raise Interrupted
        sample = self.look()
        if not self.quiet:
            linear, angular = (0.0, TURNING) if self._turning else self._shuttle.command(sample.pose)
            self._velocity.put(Velocity(stamp=time.time_ns(), linear=linear, angular=angular))
        return sample

    def look(self) -> Sample:
        """Where the robot is now."""
        told = json.loads(self.remote.tell("truth"))
        rims = self.remote.state()["speeds"]
        return Sample(told["time"], Pose(*told["pose"]), (rims["left"] + rims["right"]) / 2, told["fallen"])

    def turn_round(self) -> None:
        """Turn on the spot once, and a little more, so that the robot sees all that is around it."""
        self._turning, end = True, self.look().time + ONCE
        while self.step().time < end:
            pass
        self._turning = False

    def put_back(self) -> None:
        """Put the robot where it started."""
        self.remote.tell(f"place {START.x} {START.y} 0")

    def send(self, name: str, number: signal.Signals) -> None:
        """Send a signal to a process."""
        os.kill(self.system.supervisor.children[name].pid, number)

    def start(self, name: str) -> None:
        """Start a process that was told to end."""
        plan = self.system.plan
        commands = {"router": plan.router(), "capture": plan.capture(), **plan.base_processes()}
        self.system.supervisor.start(name, commands.get(name) or plan.service(name))

    def _wait(self, holds: Callable[[], bool], what: str) -> None:
        deadline = time.monotonic() + STARTING
        while not holds():
            self.system.poll()
            if self._stop.wait(STEP):
                raise SystemExit
            if time.monotonic() > deadline:
                raise TimeoutError(f"{what} did not start within {STARTING:.0f} s")
