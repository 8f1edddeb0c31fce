"""A recording, a depth folder or a ROS bag: a picture of every frame, or of some, and what the scans report."""

import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.progress import Progress

from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.floor.tracker import FloorTracker, tracker_of
from cliffscan.services.capture.sources.depth_source import BadFrame
from cliffscan.services.capture.sources.open_source import installed
from cliffscan.services.capture.sources.recorded import Recorded
from cliffscan.services.fuse.fusion import GridMismatch
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.system import Plan
from evaluation.census import census, census_table
from experiments.frames import Frame
from experiments.pictures import recorded_picture
from experiments.run import Run, telling

MOST_PICTURES = 12


def run_recording(run: Run, path: Path) -> None:
    """Draw and count the frames of a recording. Raises ConfigError."""
    born = time.monotonic()
    run = replace(run, overrides=[*run.overrides, "capture.source=replay", f"capture.path={path}"])
    Plan(overrides=run.overrides).check()
    name = path.resolve().stem if path.is_file() else path.resolve().name
    with closing(opened(run.config("capture", CaptureConfig))) as recorded, telling(run) as display:
        total = len(recorded)
        drawn = set(np.linspace(0, total - 1, min(MOST_PICTURES, total)).astype(int).tolist())
        ranges: dict[str, list[np.ndarray]] = {}
        for place, image, frame in frames_of(run, recorded, display.progress, name):
            for scan, told in frame.scans.items():
                ranges.setdefault(scan, []).append(told.ranges)
            if place in drawn:
                recorded_picture(run.out / f"{name}_{image}.png", f"{name}, {image}", frame, run.bands())
    counts = {scan: census(np.stack(each)) for scan, each in ranges.items()}
    if not counts:
        raise ConfigError(f"{path}: no usable image in it; the lines above say why")
    seen = len(next(iter(ranges.values())))
    title = f"{name}: what each scan reports, {seen} of {total} frames"
    run.tell(census_table(title, counts), f"{name}.md", born)


def opened(config: CaptureConfig) -> Recorded:
    """The configured recording. Raises ConfigError."""
    with installed("replay"):
        from cliffscan.services.capture.sources.replay import open_recorded

        return open_recorded(config)


def frames_of(run: Run, recorded: Recorded, progress: Progress, name: str) -> Iterator[tuple[int, str, Frame]]:
    """Each image that can be used, by place and name, with its scans; what cannot is told.

    The floor is where `capture` would have it. Raises ConfigError, SystemExit when told to stop.
    """
    negative, positive = run.config("negative", NegativeConfig), run.config("positive", PositiveConfig)
    capture = run.config("capture", CaptureConfig)
    settings = Settings(negative, positive, tuple(METHODS))
    tracker: FloorTracker | None = None
    for place, image in enumerate(progress.track(recorded.images(), total=len(recorded), description=name)):
        if run.stop.is_set():
            raise SystemExit
        try:
            frame = image.read()
        except BadFrame as error:
            progress.console.print(f"  leaving out {error}", markup=False, highlight=False, soft_wrap=True)
            continue
        camera = capture.camera(frame.camera)
        if capture.floor == "tracked":
            tracker = tracker_of(camera.floor, tracker)
            camera = replace(camera, floor=tracker.update(frame.depth, camera))
        depth = DepthImage.pack(0, 0, name, frame.depth, camera, RAW)
        try:
            scans = perceive(depth, settings)
        except GridMismatch as error:
            raise ConfigError(str(error)) from error
        combined = {"negative": scans.negative} if len(negative.methods) > 1 else {}
        of_all = {**scans.by_method, **combined, "positive": scans.positive, "fused": scans.fused}
        yield place, image.name, Frame(depth, of_all).with_paper()
