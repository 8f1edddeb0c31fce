"""The experiments from start to end: collect frames, draw them, tell what they show."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime.config import C
from cliffscan.common.runtime.service import StopSignal
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.simulator.world import World
from cliffscan.supervisor import ConfigRefused
from experiments.cloud import Bands
from experiments.collect import Silent, collect, tell
from experiments.frames import Frame, name_of, scan_paths, tells_edges
from experiments.goals import EveryFrame, FirstFrames, Goal
from experiments.known_world import angles_of, truth_of
from experiments.pictures import recorded_picture, world_pictures
from experiments.score import Score, census, score
from experiments.service_log import ServiceLog
from experiments.tables import Table, census_table, edge_table

RATE = 10.0  # [Hz] of a world: what is measured is where scans are right, on a slow machine too
MOST_PICTURES = 12  # of a recording


@dataclass(frozen=True)
class Run:
    """What every experiment needs: where to tell, when to stop, where to write, and how the services are configured."""

    console: Console
    stop: StopSignal
    out: Path
    overrides: Sequence[str]  # SERVICE.KEY=VALUE

    @property
    def log_file(self) -> Path:
        """Where the services' log lines go."""
        return self.out / "services.log"

    def config(self, service: str, kind: type[C]) -> C:
        """The configuration with which a service runs. Raises ConfigError."""
        return configuration.load(
            service, kind, None, [text for text in self.overrides if configuration.meant_for(service, text)]
        )

    def paths(self) -> list[str]:
        """The paths of all scans of a frame. Raises ConfigError."""
        return scan_paths(self.config("negative", NegativeConfig).methods)

    def bands(self) -> Bands:
        """The heights that part floor, obstacles and what is overhead. Raises ConfigError."""
        positive = self.config("positive", PositiveConfig)
        return Bands(positive.floor_band, positive.robot_height)

    def collect(self, goal: Goal, title: str, log: ServiceLog, progress: Progress, capture: Sequence[str]) -> None:
        """Run the services until the goal is reached. Raises Failed, ConfigRefused, SystemExit when told to stop."""
        settings = [*self.overrides, *(f"capture.{text}" for text in capture)]
        collect(goal, self.paths(), settings, self.stop, log, progress, title)
        if self.stop.is_set():
            raise SystemExit

    def tell(self, table: Table, file: str, born: float) -> None:
        """Print a table, write it, and say where everything is."""
        self.console.print(f"\n{table.title}", style="bold", markup=False, highlight=False, soft_wrap=True)
        self.console.print(table.rich())
        self.console.print(table.note, markup=False, highlight=False, soft_wrap=True)
        (self.out / file).write_text(table.markdown(), encoding="utf-8")
        where = f"Pictures and {file} are in {self.out.resolve()} ({time.monotonic() - born:.0f} s)"
        self.console.print(where, markup=False, highlight=False, soft_wrap=True)


def run_worlds(run: Run, names: Sequence[str], frames: int) -> None:
    """Simulated worlds: pictures of each, and the error of the edge of its hole."""
    born = time.monotonic()
    scores: dict[str, dict[str, Score]] = {}
    try:
        worlds = [World(name) for name in names]
    except ValueError as error:
        raise configuration.ConfigError(str(error)) from error
    with telling(run) as (progress, log):
        for world in worlds:
            goal = FirstFrames(frames)
            run.collect(goal, world.name, log, progress, [f"world={world.name}", "source=simulator", f"rate={RATE}"])
            scores[world.name] = score_all(world, goal.frames)
            task = progress.add_task(f"{world.name}: drawing", total=None)
            world_pictures(run.out, world, goal.frames[0], run.bands())
            progress.remove_task(task)
    methods = run.config("negative", NegativeConfig).methods
    run.tell(edge_table(scores, frames, methods), "edges.md", born)


def run_folder(run: Run, folder: Path) -> None:
    """A depth folder: a picture of every frame, or of some where they are many, and what the scans report."""
    born = time.monotonic()
    goal = EveryFrame(folder, MOST_PICTURES)
    name = folder.resolve().name
    # a frame comes back with the floor that its folder says, by which it is known
    capture = ["source=replay", f"path={folder.resolve()}", f"rate={goal.rate}", "loop=true", "floor=fixed"]
    with telling(run) as (progress, log):
        for why in goal.bad:
            progress.console.print(f"  leaving out {why}", markup=False, highlight=False, soft_wrap=True)
            log.silence(f"capture: bad_frame: {why}")
        try:
            run.collect(goal, name, log, progress, capture)
        except Silent as error:
            if not goal.done:
                raise
            progress.console.print(
                f"  {error}; without {', '.join(goal.missing)}", markup=False, highlight=False, soft_wrap=True
            )
        task = progress.add_task(f"{name}: drawing", total=len(goal.frames))
        for frame_name, frame in sorted(goal.frames.items()):
            recorded_picture(run.out / f"{name}_{frame_name}.png", f"{name}, {frame_name}", frame, run.bands())
            progress.advance(task)
    scans = list(goal.scans.values())
    counts = {name_of(path): census(np.stack([scan[path].ranges for scan in scans])) for path in scans[0]}
    run.tell(
        census_table(f"{name}: what each scan reports, {len(scans)} of {goal.total} frames", counts), f"{name}.md", born
    )


def score_all(world: World, frames: Sequence[Frame]) -> dict[str, Score]:
    """The score of every scan that is to tell where the floor ends, over all frames of one view."""
    image, scans = frames[0]
    truth = truth_of(world, image.camera, angles_of(scans["scan/fused"]))
    return {
        name_of(path): score(np.stack([frame.scans[path].ranges for frame in frames]), truth)
        for path in scans
        if tells_edges(path)
    }


@contextmanager
def telling(run: Run) -> Iterator[tuple[Progress, ServiceLog]]:
    """A progress bar, and the services' log kept away from it."""
    columns = SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=run.console) as progress, ServiceLog(run.log_file) as log:
        try:
            yield progress, log
        except ConfigRefused:  # the reason may have come after the last look at the log
            tell(progress, log)
            raise
