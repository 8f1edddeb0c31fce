"""What a film of a drive shows, each a small picture: the camera's view, the scan from above, the map as it grows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.colors import to_rgb
from PIL import Image, ImageDraw

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.simulator.world import Pose
from experiments import colours
from experiments.cloud import Bands, Kind, cloud, kinds
from experiments.known_world import angles_of
from experiments.map_pictures import UNKNOWN, pixels
from experiments.map_truth import Ground
from experiments.plan_view import FILLS, ROBOT, places

STRIDE = 2  # of the camera's pixels, one is shown
SCAN_SCALE = 58  # [px/m]
AHEAD, BEHIND, ASIDE = 3.9, 0.35, 2.75  # [m] of the scan's picture, which the robot looks up
BESIDE = 0.25  # [m] of the map's picture, around the floor plan
EVIDENCE = (Evidence.POSITIVE, Evidence.DROP, Evidence.FLOOR_LOST)

Picture = Image.Image


def camera_picture(image: DepthImage, bands: Bands) -> Picture:
    """The depth image, each pixel in the colour of what it is."""
    palette = np.array([rgb(colours.OF_KIND[kind]) for kind in Kind], np.uint8)
    return Image.fromarray(palette[kinds(cloud(image), bands)[::STRIDE, ::STRIDE]])


def scan_picture(scan: LaserScan, ground: Ground, viewpoint: Pose) -> Picture:
    """A scan from above over the true outline, the robot's heading up."""
    size = round(2 * ASIDE * SCAN_SCALE), round((AHEAD + BEHIND) * SCAN_SCALE)
    picture = Image.new("RGB", size, UNKNOWN)
    draw = ImageDraw.Draw(picture)

    def place(points: Floats) -> list[tuple[float, float]]:
        """Pixels of points (n, 2) [m] ahead and left."""
        return [((ASIDE - left) * SCAN_SCALE, (AHEAD - ahead) * SCAN_SCALE) for ahead, left in points.tolist()]

    for outline in ground.outlines:
        if outline.kind != "overhead":
            draw.polygon(place(seen_from(viewpoint, outline.polygon)), fill=FILLS[outline.kind])
    draw.polygon([*place(np.zeros((1, 2))), *place(looked(scan))], fill=mixed(colours.FREE, 0.55))
    ahead_left = np.column_stack(places(scan))
    told = scan.intensities[np.isfinite(scan.ranges)]
    for evidence in EVIDENCE:
        dots(draw, place(ahead_left[told == evidence]), colours.OF_EVIDENCE[evidence])
    disc(draw, place(np.zeros((1, 2)))[0], ROBOT * SCAN_SCALE, -math.pi / 2)
    return picture


def map_picture(grid: OccupancyGrid, ground: Ground, way: Sequence[Pose], scale: int) -> Picture:
    """The map over the true outline, and where the robot went and is. scale: [px/m]."""
    corners = np.concatenate([outline.polygon for outline in ground.outlines])
    (left, bottom), (right, top) = corners.min(axis=0) - BESIDE, corners.max(axis=0) + BESIDE
    picture = Image.new("RGB", (round((right - left) * scale), round((top - bottom) * scale)), UNKNOWN)
    draw = ImageDraw.Draw(picture)

    def place(points: Iterable[Sequence[float]]) -> list[tuple[float, float]]:
        """Pixels of points [m] of the map."""
        return [((x - left) * scale, (top - y) * scale) for x, y in points]

    cells = Image.fromarray((255 * pixels(grid, ground)[::-1]).astype(np.uint8))
    side = grid.resolution * scale
    corner = place([(grid.origin[0], grid.origin[1] + grid.height * grid.resolution)])[0]
    cells = cells.resize((round(grid.width * side), round(grid.height * side)), Image.Resampling.NEAREST)
    picture.paste(cells, (round(corner[0]), round(corner[1])))
    for outline in ground.outlines:
        if outline.kind == "obstacle":
            draw.polygon(place(outline.polygon.tolist()), outline=colours.WALL)
    dots(draw, place(ground.edges.tolist()), colours.BLUE, 0)
    draw.line(place([pose[:2] for pose in way]), fill=colours.GREEN, width=2)
    disc(draw, place([way[-1][:2]])[0], ROBOT * scale, -way[-1].yaw)
    return picture


def seen_from(viewpoint: Pose, points: Floats) -> Floats:
    """Points (n, 2) [m] of the world as seen from there: ahead and left (n, 2)."""
    cos, sin = math.cos(viewpoint.yaw), math.sin(viewpoint.yaw)
    turned: Floats = (points - viewpoint[:2]) @ np.array([[cos, -sin], [sin, cos]])
    return turned


def looked(scan: LaserScan) -> Floats:
    """How far each beam saw free ground: (beams, 2) [m] ahead and left."""
    ends: Floats = scan.free()[:, None] * np.column_stack([np.cos(angles_of(scan)), np.sin(angles_of(scan))])
    return ends


def dots(draw: ImageDraw.ImageDraw, at: Iterable[tuple[float, float]], colour: str, radius: int = 1) -> None:
    """Small squares."""
    for x, y in at:
        draw.rectangle((x - radius, y - radius, x + radius, y + radius), fill=colour)


def disc(draw: ImageDraw.ImageDraw, at: tuple[float, float], radius: float, heading: float) -> None:
    """The robot. heading: [rad] clockwise from the picture's right."""
    draw.ellipse((at[0] - radius, at[1] - radius, at[0] + radius, at[1] + radius), fill="white", outline="black")
    draw.line((*at, at[0] + radius * math.cos(heading), at[1] + radius * math.sin(heading)), fill="black", width=2)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue from 0 to 255."""
    red, green, blue = (round(255 * part) for part in to_rgb(colour))
    return red, green, blue


def mixed(colour: str, share: float) -> tuple[int, int, int]:
    """A colour thinned with white."""
    red, green, blue = (round(share * part + (1 - share) * 255) for part in rgb(colour))
    return red, green, blue
