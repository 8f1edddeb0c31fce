"""A recorded depth folder: a picture of every frame, or of some where they are many, and what the scans report."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.progress import Progress

from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.depth_source import BadFrame
from cliffscan.services.capture.sources.replay import CameraFile, images_of, read_camera, read_depth
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


def run_folder(run: Run, folder: Path) -> None:
    """Draw and count the frames of a folder. Raises ConfigError."""
    born = time.monotonic()
    Plan(overrides=[*run.overrides, "capture.source=replay", f"capture.path={folder.resolve()}"]).check()
    file, images, name = read_camera(folder), images_of(folder), folder.resolve().name
    drawn = {images[place] for place in np.linspace(0, len(images) - 1, min(MOST_PICTURES, len(images))).astype(int)}
    ranges: dict[str, list[np.ndarray]] = {}
    with telling(run) as display:
        for image, frame in frames_of(run, file, images, display.progress, name):
            for scan, told in frame.scans.items():
                ranges.setdefault(scan, []).append(told.ranges)
            if image in drawn:
                recorded_picture(run.out / f"{name}_{image.stem}.png", f"{name}, {image.stem}", frame, run.bands())
    counts = {scan: census(np.stack(each)) for scan, each in ranges.items()}
    if not counts:
        raise ConfigError(f"{folder}: no usable PNG in it; the lines above say why")
    seen = len(next(iter(ranges.values())))
    title = f"{name}: what each scan reports, {seen} of {len(images)} frames"
    run.tell(census_table(title, counts), f"{name}.md", born)


def frames_of(
    run: Run, file: CameraFile, images: list[Path], progress: Progress, name: str
) -> Iterator[tuple[Path, Frame]]:
    """Each image that can be used with its scans, over the floor that its folder says; what cannot is told.

    Raises ConfigError, SystemExit when told to stop.
    """
    negative, positive = run.config("negative", NegativeConfig), run.config("positive", PositiveConfig)
    settings = Settings(negative, positive, tuple(METHODS))
    for image in progress.track(images, description=name):
        if run.stop.is_set():
            raise SystemExit
        try:
            camera = file.camera_of(image.stem)
            depth = DepthImage.pack(0, 0, name, read_depth(image, camera.width, camera.height), camera, RAW)
        except BadFrame as error:
            progress.console.print(f"  leaving out {error}", markup=False, highlight=False, soft_wrap=True)
            continue
        try:
            scans = perceive(depth, settings)
        except GridMismatch as error:
            raise ConfigError(str(error)) from error
        combined = {"negative": scans.negative} if len(negative.methods) > 1 else {}
        of_all = {**scans.by_method, **combined, "positive": scans.positive, "fused": scans.fused}
        yield image, Frame(depth, of_all).with_paper()
