"""Simulated worlds through the real services: pictures of each, and the error of the edge of its hole."""

import os
import time
from collections.abc import Mapping, Sequence

from rich.progress import Progress

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH, SCAN_FUSED, SCAN_NEGATIVE, SCAN_OF_METHOD, SCAN_POSITIVE
from cliffscan.common.runtime.config import SENSING, ConfigError
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.simulator.world import World
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint
from evaluation.processes.service_log import ServiceLog
from evaluation.processes.watch import Watch
from evaluation.truth.world_truth import world_truth
from experiments.edges import Score, edge_table, score
from experiments.frames import Frame, Gathering
from experiments.pictures import world_pictures
from experiments.run import Run, tell, telling

RATE = 10.0  # [Hz]: what is measured is where scans are right, on a slow machine too
ROOM = 512  # samples that may wait to be read: some seconds of all keys
TURN = 0.1  # [s] the longest wait, so how often the processes are looked after


class FirstFrames:
    """The first `total` frames, whatever they show."""

    unit = "frames"
    patience = 30.0

    def __init__(self, total: int) -> None:
        self.total = total
        self.frames: list[Frame] = []

    @property
    def done(self) -> int:
        """How many frames are there."""
        return len(self.frames)


def run_worlds(run: Run, names: Sequence[str], frames: int) -> None:
    """Frames of each world: pictures of the first, and a table of all scores. Raises ConfigError, Failed."""
    born = time.monotonic()
    scores: dict[str, dict[str, Score]] = {}
    methods = run.config("negative", NegativeConfig).methods
    try:
        worlds = [World(name) for name in names]
    except ValueError as error:
        raise ConfigError(str(error)) from error
    with telling(run) as (progress, log):
        for world in worlds:
            goal = FirstFrames(frames)
            collect(run, world.name, scan_names(methods), goal, log, progress)
            scores[world.name] = score_all(world, goal.frames)
            task = progress.add_task(f"{world.name}: drawing", total=None)
            world_pictures(run.out, world, goal.frames[0], run.bands())
            progress.remove_task(task)
    run.tell(edge_table(scores, frames, methods), "edges.md", born)


def scan_names(methods: Sequence[str]) -> dict[str, str]:
    """All scans of a frame, name by path; `negative` where it is more than the one of `methods` that it is made of."""
    each = {SCAN_OF_METHOD.named(method).path: method for method in METHODS}
    combined = {SCAN_NEGATIVE.path: "negative"} if len(methods) > 1 else {}
    return {**each, **combined, SCAN_POSITIVE.path: "positive", SCAN_FUSED.path: "fused"}


def score_all(world: World, frames: Sequence[Frame]) -> dict[str, Score]:
    """The score of every scan that is to tell where the floor ends, over all frames of one view."""
    image, scans = frames[0]
    truth = world_truth(world, image.camera, scans["fused"].grid().angles())
    return {name: score([each.scans[name] for each in frames], truth) for name in scans if name != "positive"}


def collect(
    run: Run, world: str, names: Mapping[str, str], goal: FirstFrames, log: ServiceLog, progress: Progress
) -> None:
    """Run the services in a world until the goal is reached, and end them; names: as for Gathering.

    Raises Failed, ConfigRefused, SystemExit when told to stop.
    """
    task = progress.add_task(world, total=goal.total)
    queue: LatestQueue[tuple[str, bytes]] = LatestQueue(ROOM)
    capture = [f"capture.world={world}", "capture.source=simulator", f"capture.rate={RATE}"]
    plan = Plan(f"demo-{os.getpid()}", [free_endpoint()], overrides=[*run.overrides, *capture])
    gathering = Gathering(names)
    with System(plan, run.stop) as system:
        run.stop.patient = True
        for path in (DEPTH.path, *names):
            system.bus.subscribe(path, lambda key, payload: queue.put((key, payload)))
        watch = Watch(system, SENSING, "collecting frames")
        while goal.done < goal.total and not run.stop.is_set():
            watch.look(goal)
            tell(progress, log)
            progress.update(task, completed=goal.done, description=f"{world}: {watch.state}")
            arrived = queue.get(TURN)
            if arrived and (frame := gathering.take(*decoded(*arrived))):
                goal.frames.append(frame.with_paper())
        progress.update(task, completed=goal.done, description=f"{world}: ending the services")
    run.stop.patient = False
    if run.stop.is_set():  # the last words are of processes that were interrupted
        raise SystemExit
    tell(progress, log)
    progress.update(task, description=world)


def decoded(path: str, payload: bytes) -> tuple[str, DepthImage | LaserScan]:
    """The message that came on a path, with the path."""
    return path, (DepthImage if path == DEPTH.path else LaserScan).decode(payload)
