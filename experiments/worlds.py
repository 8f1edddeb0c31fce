"""Simulated worlds through the real services: pictures of each, and the error of the edge of its hole."""

import os
import time
from collections.abc import Mapping, Sequence

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import DEPTH, SCAN_FUSED, SCAN_NEGATIVE, SCAN_OF_METHOD, SCAN_POSITIVE
from cliffscan.common.runtime.config import SENSING, ConfigError
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.simulator.world import World
from cliffscan.system import Plan
from evaluation.processes.hosts import running
from evaluation.processes.watch import Watch
from evaluation.truth.world_truth import world_truth
from experiments.edges import Score, edge_table, score
from experiments.frames import Frame, Gathering
from experiments.pictures import world_pictures
from experiments.run import RECORDER, Display, Run, telling

RATE = 10.0  # [Hz]: what is measured is where scans are right, on a slow machine too


class FirstFrames:
    """The first `total` frames, whatever they show; names: as for Gathering."""

    unit = "frames"
    patience = 30.0

    def __init__(self, total: int, names: Mapping[str, str]) -> None:
        self.total = total
        self.paths = (DEPTH.path, *names)
        self.frames: list[Frame] = []
        self._gathering = Gathering(names)

    @property
    def done(self) -> int:
        """How many frames are there."""
        return len(self.frames)

    def receive(self, path: str, payload: bytes) -> None:
        """Take in what was published on a path."""
        message = (DepthImage if path == DEPTH.path else LaserScan).decode(payload)
        if frame := self._gathering.take(path, message):
            self.frames.append(frame.with_paper())


def run_worlds(run: Run, names: Sequence[str], frames: int) -> None:
    """Frames of each world: pictures of the first, and a table of all scores. Raises ConfigError, Failed."""
    born = time.monotonic()
    scores: dict[str, dict[str, Score]] = {}
    methods = run.config("negative", NegativeConfig).methods
    try:
        worlds = [World(name) for name in names]
    except ValueError as error:
        raise ConfigError(str(error)) from error
    with telling(run) as display:
        for world in worlds:
            goal = FirstFrames(frames, scan_names(methods))
            collect(run, world.name, goal, display)
            scores[world.name] = score_all(world, goal.frames)
            task = display.progress.add_task(f"{world.name}: drawing", total=None)
            world_pictures(run.out, world, goal.frames[0], run.bands())
            display.progress.remove_task(task)
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


def collect(run: Run, world: str, goal: FirstFrames, display: Display) -> None:
    """Run the services in a world until the goal is reached, and end them.

    Raises Failed, ConfigRefused, SystemExit when told to stop.
    """
    capture = [f"capture.world={world}", "capture.source=simulator", f"capture.rate={RATE}"]
    plan = Plan(f"demo-{os.getpid()}", overrides=[*run.overrides, *capture])
    with running(plan, run.stop, run.secure) as hosts, hosts.bus(RECORDER) as bus:
        run.stop.patient = True
        watch = Watch(hosts, SENSING, "collecting frames")
        for arrived in display.attend(bus, watch, goal, run.stop, world):
            goal.receive(*arrived)
    run.stop.patient = False
    display.tell()
    display.ended(world)
