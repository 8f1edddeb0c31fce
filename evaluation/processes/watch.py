"""Notices when processes that were started for something die, or do not get on."""

import time
from collections.abc import Callable, Collection
from typing import Protocol

from cliffscan.system import System

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


class Watch:
    """Looks whether the processes live and get on: first all that are wanted have to work, then there is work to do."""

    def __init__(
        self, system: System, wanted: Collection[str], work: str, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.system, self._wanted, self._work, self._clock = system, wanted, work, clock
        self._pids: dict[str, int] = {}
        self._progress = (0, 0)  # services that are ready, and what is done
        self._since = clock()

    @property
    def started(self) -> bool:
        """Whether all that are wanted work."""
        return self.system.alive.issuperset(self._wanted)

    @property
    def state(self) -> str:
        """What is waited for."""
        starting = [name for name in self._wanted if name not in self.system.alive]
        return f"starting {', '.join(starting)}" if starting else self._work

    def look(self, goal: Goal) -> None:
        """Look after the processes. Raises Failed, ConfigRefused."""
        self.system.poll()
        for name, child in self.system.supervisor.children.items():
            if self._pids.setdefault(name, child.pid) != child.pid:
                raise Failed(f"{name} died")
        progress = len(self.system.alive), goal.done
        now = self._clock()
        if progress != self._progress:
            self._progress, self._since = progress, now
        patience = goal.patience if self.started else STARTING
        if now - self._since > patience:
            raise Failed(
                f"nothing new for {patience:.0f} s while {self.state}: {goal.done} of {goal.total} {goal.unit}"
            )
