"""A film of the drive, as an animated GIF: what the camera sees, what the scan tells, and the map that comes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from PIL import Image, ImageDraw, ImageFont

from cliffscan.common.contract.map_messages import OccupancyGrid
from experiments import colours
from experiments.cloud import Bands
from experiments.film_panels import Picture, camera_picture, map_picture, scan_picture
from experiments.frames import Frame
from experiments.map_pictures import OCCUPIED, UNKNOWN, WRONGLY_FREE
from experiments.map_truth import Ground
from experiments.truth_feed import Truth

SCAN = "scan/fused"
SCALES = {"fused": 60, "paper": 29, "positive": 29}  # [px/m] of the maps
COLOURS = 64
PACE = 100  # [ms] a picture is shown
LAST = 3000  # [ms] the last one
GAP, LINE = 8, 20  # [px]
FONT = ImageFont.load_default(size=13)
LEGENDS = (
    {
        "floor": colours.GREEN,
        "below": colours.BLUE,
        "in the way": colours.RED,
        "above": colours.YELLOW,
        "nothing": colours.BLACK,
    },
    {"free": colours.FREE, "obstacle": colours.RED, "drop": colours.BLUE, "floor lost": colours.PURPLE},
    {
        "free": "#FFFFFF",
        "occupied": OCCUPIED,
        "unknown": UNKNOWN,
        "free beyond an edge": WRONGLY_FREE,
        "true edge": colours.BLUE,
        "way": colours.GREEN,
    },
)


class Scenery(NamedTuple):
    """What stays the same throughout a film, and the maps as they grow, by name."""

    ground: Ground
    bands: Bands
    maps: Mapping[str, Sequence[OccupancyGrid]]


def write_film(path: Path, frames: Sequence[Frame], truth: Mapping[int, Truth], scenery: Scenery) -> Path:
    """Draw a picture of each frame whose truth, by stamp [ns], is known; returns the path."""
    pictures = []
    for frame in frames:
        way = [truth[stamp] for stamp in sorted(truth) if stamp <= frame.image.stamp]
        if frame.image.stamp in truth and len(way) > 1:
            pictures.append(page(frame, way, scenery))
    palette = pictures[-1].quantize(colors=COLOURS, dither=Image.Dither.NONE)  # the last one shows the most
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    times = [PACE] * (len(flat) - 1) + [LAST]
    flat[0].save(path, save_all=True, append_images=flat[1:], duration=times, loop=0, optimize=True)
    return path


def page(frame: Frame, truth: Sequence[Truth], scenery: Scenery) -> Picture:
    """All that there is to see at one moment; truth: from the start up to it."""
    camera = camera_picture(frame.image, scenery.bands)
    scan = scan_picture(frame.scans[SCAN], scenery.ground, truth[-1].viewpoint)
    way = [each.pose for each in truth]
    large, *small = (
        map_picture(newest(scenery.maps[name], frame.image.stamp), scenery.ground, way, scale)
        for name, scale in SCALES.items()
    )
    right, below = camera.width + 2 * GAP, camera.height + 2 * LINE + 2 * GAP
    bottom = large.height + 2 * LINE + 2 * GAP
    picture = Image.new("RGB", (right + large.width + GAP, bottom + LINE + small[0].height + GAP), "white")
    seconds = truth[-1].time - truth[0].time
    put(picture, camera, (GAP, GAP), "What the Kinect sees", LEGENDS[0])
    put(picture, scan, (GAP, below), "The fused scan, over the true outline", LEGENDS[1])
    put(picture, large, (right, GAP), f"The map of the fused scan, {seconds:.0f} s", LEGENDS[2])
    put(picture, small[0], (right, bottom), "of the paper's combined scan", {})
    put(picture, small[1], (right + large.width - small[1].width, bottom), "of the positive scan", {})
    return picture


def newest(maps: Sequence[OccupancyGrid], stamp: int) -> OccupancyGrid:
    """The last map that was said before a time [ns], or the first one."""
    return max((grid for grid in maps if grid.stamp <= stamp), key=lambda grid: grid.stamp, default=maps[0])


def put(picture: Picture, part: Picture, corner: tuple[int, int], title: str, legend: Mapping[str, str]) -> None:
    """Place a part with its title above and its legend below."""
    draw = ImageDraw.Draw(picture)
    x, y = corner
    draw.text((x, y), title, fill="black", font=FONT)
    picture.paste(part, (x, y + LINE))
    y += LINE + part.height + 4
    for name, colour in legend.items():
        draw.rectangle((x, y + 3, x + 9, y + 12), fill=colour, outline="#606060")
        draw.text((x + 13, y), name, fill="black", font=FONT)
        x += 13 + round(draw.textlength(name, font=FONT)) + 8
