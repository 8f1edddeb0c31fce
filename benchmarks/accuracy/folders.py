"""Recorded frames of a depth folder: nobody knows the truth of them, so what each scan reports is counted."""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from benchmarks.accuracy.frames import Frame
from benchmarks.accuracy.scans import Others, all_beams
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.depth_folder import images_of, read_camera, read_depth
from cliffscan.services.capture.sources.depth_source import BadFrame
from evaluation.census import census, census_table


def folder_section(folder: Path, scans: Sequence[str], others: Others) -> str:
    """What each scan reports of a folder's frames, as Markdown. Raises ConfigError."""
    shots = [all_beams(frame, scans, others) for frame in folder_frames(folder)]
    if not shots:
        raise ConfigError(f"{folder}: no usable PNG in it; the lines above say why")
    counts = {scan: census(np.stack([beams[scan].ranges for beams in shots])) for scan in shots[0]}
    return census_table(f"{folder.name}: {len(shots)} frames, the floor as its folder says", counts).markdown(level=2)


def folder_frames(folder: Path) -> Iterator[Frame]:
    """The frames of a folder; what is none is left out with a line. Raises ConfigError."""
    file = read_camera(folder)
    for image in images_of(folder):
        try:
            camera = file.camera_of(image.stem)
            depth = read_depth(image, camera.width, camera.height)
        except BadFrame as error:
            print(f"{folder.name}: leaving out {error}", file=sys.stderr)
            continue
        yield Frame(depth, camera, camera, folder.name)
