"""What every experiment of the demo needs: its configuration, a place to write, a progress bar, a table at the end."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import C
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.supervisor import ConfigRefused
from evaluation.pictures.cloud import Bands
from evaluation.processes.service_log import ServiceLog
from evaluation.processes.watch import Goal, Watch
from evaluation.tables import Table

RECORDER, DRIVER = "recorder", "driver"  # roles of the experiment itself
ROOM = 1024  # samples that may wait to be read: some seconds of all keys
TURN = 0.1  # [s] the longest wait, so how often the processes are looked after


@dataclass(frozen=True)
class Run:
    """Where to tell, when to stop, where to write, and how the services are configured."""

    console: Console
    stop: StopSignal
    out: Path
    overrides: Sequence[str]  # SERVICE.KEY=VALUE
    secure: bool = False  # with keys, robot and workstation each behind a router of its own

    @property
    def log_file(self) -> Path:
        """Where the services' log lines go."""
        return self.out / "services.log"

    def config(self, service: str, kind: type[C]) -> C:
        """The configuration with which a service runs. Raises ConfigError."""
        own = [text for text in self.overrides if configuration.meant_for(service, text)]
        return configuration.load(service, kind, None, own)

    def bands(self) -> Bands:
        """The heights that part floor, obstacles and what is overhead. Raises ConfigError."""
        positive = self.config("positive", PositiveConfig)
        return Bands(positive.floor_band, positive.robot_height)

    def tell(self, table: Table, file: str, born: float) -> None:
        """Print a table, write it, and say where everything is."""
        self.console.print(f"\n{table.title}", style="bold", markup=False, highlight=False, soft_wrap=True)
        self.console.print(table.rich())
        self.console.print(table.note, markup=False, highlight=False, soft_wrap=True)
        (self.out / file).write_text(table.markdown(), encoding="utf-8")
        where = f"Pictures and {file} are in {self.out.resolve()} ({time.monotonic() - born:.0f} s)"
        self.console.print(where, markup=False, highlight=False, soft_wrap=True)


class Display(NamedTuple):
    """A progress bar, and the services' log, which is kept away from it."""

    progress: Progress
    log: ServiceLog

    def tell(self, expected: tuple[str, ...] = ()) -> None:
        """Print what the services complain of, but for what begins with an `expected` text."""
        for line in self.log.complaints():
            if not line.startswith(expected):
                self.progress.console.print(f"  {line}", markup=False, highlight=False, soft_wrap=True)

    def attend(
        self, bus: Bus, watch: Watch, goal: Goal, stop: StopSignal, name: str, expected: tuple[str, ...] = ()
    ) -> Iterator[tuple[str, bytes]]:
        """What is published on the goal's paths, with its path, until the goal is reached; all is looked after.

        Raises Failed, ConfigRefused, SystemExit when told to stop.
        """
        queue: LatestQueue[tuple[str, bytes]] = LatestQueue(ROOM)
        for path in goal.paths:
            bus.subscribe(path, lambda key, payload: queue.put((key, payload)))
        task = self.progress.add_task(name, total=goal.total)
        while goal.done < goal.total:
            watch.look(goal)
            self.tell(expected)
            self.progress.update(task, completed=goal.done, description=f"{name}: {watch.state}")
            if stop.is_set():
                raise SystemExit
            if arrived := queue.get(TURN):
                yield arrived
        self.progress.update(task, completed=goal.done, description=f"{name}: ending the services")

    def ended(self, name: str) -> None:
        """Show that what was attended to last has ended."""
        self.progress.update(self.progress.task_ids[-1], description=name)


@contextmanager
def telling(run: Run) -> Iterator[Display]:
    """A display on the run's console."""
    columns = SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=run.console) as progress, ServiceLog(run.log_file) as log:
        display = Display(progress, log)
        try:
            yield display
        except ConfigRefused:  # the reason may have come after the last look at the log
            display.tell()
            raise
