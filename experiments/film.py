"""A film of the mapping drive, as an animated GIF: python -m experiments.film FILE. For the README; run by hand.

Each picture shows what the camera sees, what the fused scan tells, and the maps of the three scans as they grow.
"""

import argparse
import io
import tempfile
from collections.abc import Sequence
from pathlib import Path

from PIL import Image
from rich.console import Console

from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.runtime.service import StopSignal
from cliffscan.simulator.truth import Outline
from evaluation.pictures.cloud import cloud, kinds
from evaluation.pictures.maps import map_panel
from evaluation.pictures.panels import Scene, kind_panel, scan_panel
from evaluation.pictures.plan import Extent, seen_from
from evaluation.pictures.sheet import sheet
from experiments.frames import Frame
from experiments.mapping import NAMES, ROUND, Drive, drive_round
from experiments.run import Run, telling

SIZE = (864, 560)  # [px]
COLOURS = 64
EVERY = 2  # frames
PACE, LAST = 200, 3000  # [ms] that a picture is shown, and the last one
EXTENT = Extent(3.9, 2.75)  # [m] of the scan's picture


def picture(run: Run, drive: Drive, frame: Frame) -> Image.Image:
    """All that there is to see at the moment of a frame."""
    stamp = frame.image.stamp
    way = [truth.pose for at, truth in drive.truth.items() if at <= stamp]
    viewpoint = drive.truth[stamp].viewpoint
    outlines = [Outline(seen_from(viewpoint, each.polygon), each.kind) for each in drive.ground.outlines]
    scene = Scene(EXTENT, frame.scans["fused"], outlines)
    panels = [
        kind_panel(kinds(cloud(frame.image), run.bands()), "What the Kinect sees"),
        scan_panel(scene, frame.scans["fused"], "The fused scan, over the true outline"),
        *(
            map_panel(newest(grids, stamp), drive.ground, drive.in_view, way, f"Map: {NAMES[name]}")
            for name, grids in reversed(drive.survey.maps.items())
        ),
    ]
    seconds = drive.truth[stamp].time - next(iter(drive.truth.values())).time
    written = io.BytesIO()
    sheet(f"A drive past descending stairs, {seconds:.0f} s", panels, 3).savefig(written)
    return Image.open(written).convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)


def newest(maps: Sequence[OccupancyGrid], stamp: int) -> OccupancyGrid:
    """The last map that was published before a time [ns], or the first one."""
    return max((grid for grid in maps if grid.stamp <= stamp), key=lambda grid: grid.stamp, default=maps[0])


def main() -> None:
    """Drive, and write the film."""
    parser = argparse.ArgumentParser(prog="python -m experiments.film", description=__doc__)
    parser.add_argument("file", type=Path, help="the GIF to write")
    file = parser.parse_args().file
    with tempfile.TemporaryDirectory() as out:
        run = Run(Console(), StopSignal(), Path(out), [])
        run.log_file.touch()
        with telling(run) as display:
            drive = drive_round(run, "odometry_map", ROUND, display)
            frames = [frame for frame in drive.survey.frames if frame.image.stamp in drive.truth][1::EVERY]
            pictures = [picture(run, drive, frame) for frame in display.progress.track(frames, description="drawing")]
    colours = pictures[-1].quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)  # near the palette
    flat = [each.quantize(palette=colours, dither=Image.Dither.NONE) for each in pictures]
    times = [PACE] * (len(flat) - 1) + [LAST]
    flat[0].save(file, save_all=True, append_images=flat[1:], duration=times, loop=0, optimize=True)


if __name__ == "__main__":
    main()
