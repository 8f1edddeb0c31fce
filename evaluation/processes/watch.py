"""Notices when processes that were started for something die, or do not get on."""

import time
from collections.abc import Callable, Collection, Mapping
from typing import Protocol

from cliffscan.supervisor import Child

STARTING = 120.0  # [s] for the next service to be ready: on a slow machine kernels take long to compile


class Failed(Exception):
    """What is wanted cannot be had; the text is one line that says why."""


class Goal(Protocol):
    """What all the processes are for."""

    unit: str  # what is counted
    total: int  # wanted
    patience: float  # [s] without a new one, after which it is of no use to go on

    @property
    def paths(self) -> Collection[str]:
        """On which comes what is wanted."""

    @property
    def done(self) -> int:
        """How many of the wanted ones are there."""


class Processes(Protocol):
    """What is looked after."""

    @property
    def alive(self) -> set[str]:
        """The services that work."""

    @property
    def children(self) -> Mapping[str, Child]:
        """The processes by name."""

    def poll(self) -> None:
        """Start again what has ended, and what waits for another. Raises ConfigRefused."""


class Watch:
    """Looks whether the processes live and get on: first all that are wanted have to work, then there is work to do."""

    def __init__(
        self, processes: Processes, wanted: Collection[str], work: str, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._processes, self._wanted, self._work, self._clock = processes, wanted, work, clock
        self._pids: dict[str, int] = {}
        self._progress = (0, 0)  # services that are ready, and what is done
        self._since = clock()

    @property
    def started(self) -> bool:
        """Whether all that are wanted work."""
        return self._processes.alive.issuperset(self._wanted)

    @property
    def state(self) -> str:
        """What is waited for."""
        starting = [name for name in self._wanted if name not in self._processes.alive]
        return f"starting {', '.join(starting)}" if starting else self._work

    def look(self, goal: Goal) -> None:
        """Look after the processes. Raises Failed, ConfigRefused."""
        self._processes.poll()
        for name, child in self._processes.children.items():
            if self._pids.setdefault(name, child.pid) != child.pid:
                raise Failed(f"{name} died")
        progress = len(self._processes.alive), goal.done
        now = self._clock()
        if progress != self._progress:
            self._progress, self._since = progress, now
        patience = goal.patience if self.started else STARTING
        if now - self._since > patience:
            raise Failed(
                f"nothing new for {patience:.0f} s while {self.state}: {goal.done} of {goal.total} {goal.unit}"
            )
