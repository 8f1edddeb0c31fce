"""Frames and their scans from the real services, started for this and ended again."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Collection, Sequence
from typing import Protocol

from rich.progress import Progress

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH
from cliffscan.common.runtime.config import SENSING
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import StopSignal
from cliffscan.supervisor import Supervisor
from cliffscan.system import Plan, System
from experiments.frames import Gathering
from experiments.goals import Aim, Goal
from experiments.service_log import ServiceLog

ROOM = 512  # samples that may wait to be read: some seconds of all keys
TURN = 0.1  # [s] the longest wait, so how often the processes are looked after
STARTING = 120.0  # [s] for the next service to be ready: on a slow machine kernels take long to compile


class Failed(Exception):
    """The frames cannot be had; the text is one line that says why."""


class Silent(Failed):
    """The services work, but nothing that is wanted comes."""


def collect(
    goal: Goal,
    paths: Sequence[str],
    overrides: Sequence[str],
    stop: StopSignal,
    log: ServiceLog,
    progress: Progress,
    title: str,
) -> None:
    """Run the system, with the scans on `paths`, until the goal is reached or `stop` is set; then end it all.

    Raises Failed where a service dies, Silent where what is wanted does not come, ConfigRefused.
    """
    task = progress.add_task(title, total=goal.total)
    queue: LatestQueue[tuple[str, bytes]] = LatestQueue(ROOM)
    plan = Plan(f"demo-{os.getpid()}", [f"tcp/127.0.0.1:{free_port()}"], overrides=overrides)
    gathering = Gathering(paths)
    with System(plan, stop) as system:
        stop.patient = True
        for path in (DEPTH.path, *paths):
            system.bus.subscribe(path, lambda key, payload: queue.put((key, payload)))
        watch = Watch(system)
        while goal.done < goal.total and not stop.is_set():
            watch.look(goal)
            tell(progress, log)
            progress.update(task, completed=goal.done, description=f"{title}: {watch.state}")
            arrived = queue.get(TURN)
            frame = gathering.take(*_decoded(*arrived)) if arrived else None
            if frame:
                goal.take(frame)
        progress.update(task, completed=goal.done, description=f"{title}: ending the services")
    stop.patient = False
    if not stop.is_set():  # or else the last words are of processes that were interrupted
        tell(progress, log)
    progress.update(task, description=title)


class Watched(Protocol):
    """Processes that are looked after."""

    @property
    def supervisor(self) -> Supervisor:
        """The processes."""

    @property
    def alive(self) -> set[str]:
        """What works."""

    def poll(self) -> None:
        """Look after the processes. Raises ConfigRefused."""


class Watch:
    """Looks whether the processes live and get on: first all that are wanted have to work, then there is work to do."""

    def __init__(
        self,
        system: Watched,
        clock: Callable[[], float] = time.monotonic,
        wanted: Collection[str] = SENSING,
        work: str = "collecting frames",
    ) -> None:
        self._system, self._clock = system, clock
        self._wanted, self._work = wanted, work
        self._pids: dict[str, int] = {}
        self._progress = (0, 0)  # services that are ready, frames that are there
        self._since = clock()

    @property
    def started(self) -> bool:
        """Whether all that are wanted work."""
        return self._system.alive.issuperset(self._wanted)

    @property
    def state(self) -> str:
        """What is waited for."""
        starting = [name for name in self._wanted if name not in self._system.alive]
        return f"starting {', '.join(starting)}" if starting else self._work

    def look(self, goal: Aim) -> None:
        """Look after the processes. Raises Failed, Silent, ConfigRefused."""
        self._system.poll()
        for name, child in self._system.supervisor.children.items():
            if self._pids.setdefault(name, child.pid) != child.pid:
                raise Failed(f"{name} died")
        progress = len(self._system.alive), goal.done
        now = self._clock()
        if progress != self._progress:
            self._progress, self._since = progress, now
        patience = goal.patience if self.started else STARTING
        if now - self._since > patience:
            raise Silent(
                f"nothing new for {patience:.0f} s while {self.state}: {goal.done} of {goal.total} {goal.unit}"
            )


def free_port() -> int:
    """A TCP port of this machine that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def _decoded(path: str, payload: bytes) -> tuple[str, DepthImage | LaserScan]:
    return path, (DepthImage if path == DEPTH.path else LaserScan).decode(payload)


def tell(progress: Progress, log: ServiceLog, expected: tuple[str, ...] = ()) -> None:
    """Print what the services complain of, but for what begins with an `expected` text."""
    for line in log.complaints():
        if not line.startswith(expected):
            progress.console.print(f"  {line}", markup=False, highlight=False, soft_wrap=True)
