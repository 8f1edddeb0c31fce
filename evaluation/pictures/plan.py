"""The scene from above: robot, field of view, and what is truly there, in the robot's frame with its heading up."""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon
from matplotlib.ticker import MaxNLocator

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.messages import LaserScan
from cliffscan.simulator.truth import Outline
from cliffscan.simulator.world import Pose
from evaluation import palette
from evaluation.palette import Fill, Mark, Stroke
from evaluation.pictures.cloud import Cloud

ROBOT = 0.177  # [m] radius of a TurtleBot 2
TICKS = 6  # intervals between the labels aside
MARGIN = 1.15
LEAST = 1.0  # [m] ahead that is shown at least
NARROWEST = 0.55  # aside, as a share of ahead: what fills a panel
MOST = 99.5  # [%] of the numbers that must be within the picture: the rest are stray
HATCH = "#707070"
LAYER = {"lower": 1.0, "floor": 1.2, "obstacle": 1.3, "overhead": 1.3}


class Extent(NamedTuple):
    """How much of the floor a picture shows [m]: from just behind the robot to `ahead`, and `aside` on either hand."""

    ahead: float
    aside: float


def extent_of(points: Cloud, scans: Sequence[LaserScan]) -> Extent:
    """Enough for the numbers of the scans, of which there is at least one scan; without a number, for the points."""
    numbers = [places(scan) for scan in scans]
    ahead, left = (np.concatenate(each) for each in zip(*numbers, strict=True))
    if not ahead.size:
        usable = np.isfinite(points.height)
        ahead, left = points.ahead[usable], points.left[usable]
    if not ahead.size:
        return Extent(LEAST, LEAST * NARROWEST)
    farthest, aside = (MARGIN * float(np.percentile(np.abs(each), MOST)) for each in (ahead, left))
    return Extent(max(farthest, LEAST), max(aside, NARROWEST * max(farthest, LEAST)))


def places(scan: LaserScan) -> tuple[Floats, Floats]:
    """Ahead and left [m] of every number of a scan: two of (numbers,)."""
    reported = np.isfinite(scan.ranges)
    angles, ranges = scan.grid().angles()[reported], scan.ranges[reported].astype(np.float64)
    return ranges * np.cos(angles), ranges * np.sin(angles)


def prepare(axes: Axes, extent: Extent) -> None:
    """Set up axes on which (left, ahead) [m] is plotted: left is left, ahead is up, the robot at the origin."""
    axes.set_aspect("equal")
    axes.set_xlim(extent.aside, -extent.aside)
    axes.set_ylim(-0.06 * extent.ahead - ROBOT, extent.ahead)
    axes.xaxis.set_major_locator(MaxNLocator(TICKS))
    axes.set_xlabel("y [m], to the left")
    axes.set_ylabel("x [m], ahead")
    axes.grid(color="white", linewidth=0.5, alpha=0.6)
    axes.add_patch(Circle((0, 0), ROBOT, facecolor="white", edgecolor="black", linewidth=1.2, zorder=6))
    axes.plot([0, 0], [0, ROBOT], color="black", linewidth=1.2, zorder=6)


def draw_field_of_view(axes: Axes, scan: LaserScan) -> list[Artist]:
    """The first and the last beam, and how far the sensor reaches; returns the legend."""
    angles = np.linspace(scan.angle_min, scan.angle_max, 60)
    x, y = scan.range_max * np.cos(angles), scan.range_max * np.sin(angles)
    return line(axes, np.array([[0.0, *y, 0.0], [0.0, *x, 0.0]]).T, palette.VIEW, 4.0)


def draw_pieces(axes: Axes, pieces: Iterable[Outline], upward: bool) -> list[Artist]:
    """What is truly there; returns the legend of what is within the axes. upward: (left, ahead) is plotted."""
    legend: list[Artist] = []
    for piece in pieces:
        corners = piece.polygon[:, ::-1] if upward else piece.polygon
        legend += area(axes, corners, palette.PIECES[piece.kind], LAYER[piece.kind])
    return legend


def draw_edge(axes: Axes, pieces: Iterable[Outline]) -> list[Artist]:
    """The borders of all floor, where (left, ahead) is plotted; pieces that draw_pieces fills hide the seams."""
    floors = [piece.polygon for piece in pieces if piece.kind == "floor"]
    return [each for ring in floors for each in line(axes, ring[:, ::-1], palette.EDGE, 1.1)]


def area(axes: Axes, corners: Floats, fill: Fill, layer: float, alpha: float | None = None) -> list[Artist]:
    """Fill a polygon (n, 2); returns the legend, which is empty where the axes show none of it."""
    border = HATCH if fill.hatch else "none"
    axes.add_patch(
        Polygon(corners, facecolor=fill.colour, hatch=fill.hatch, edgecolor=border, lw=0.0, zorder=layer, alpha=alpha)
    )
    return [swatch(fill, alpha)] if shown(axes, corners) else []


def line(axes: Axes, points: Floats, how: Stroke, layer: float) -> list[Artist]:
    """Draw a line through points (n, 2), with gaps at NaN; returns the legend, which is empty where it is not seen."""
    axes.plot(*points.T, color=how.colour, linestyle=how.style, linewidth=how.width, zorder=layer)
    if not shown(axes, points):
        return []
    return [Line2D([], [], color=how.colour, linestyle=how.style, linewidth=how.width, label=how.name)]


def dots(axes: Axes, points: Floats, how: Mark, layer: float, every: int = 1) -> list[Artist]:
    """Draw points (n, 2), of each `every` one with its marker, the others small; returns the legend."""
    if not shown(axes, points):
        return []
    if every > 1:
        axes.plot(*points.T, ".", color=how.colour, ms=4.0, zorder=layer)
    marks = Line2D(*points[every // 2 :: every].T, zorder=layer + 0.1)
    entry = Line2D([], [], label=how.name)
    border = palette.BLACK if how.colour in palette.LIGHT else palette.WHITE
    for each in (marks, entry):
        each.set(color=how.colour, marker=how.marker, ms=5.5, linestyle="none", mec=border, mew=0.5)
    axes.add_line(marks)
    return [entry]


def swatch(fill: Fill, alpha: float | None = None) -> Artist:
    """An area in a legend."""
    return Patch(facecolor=fill.colour, hatch=fill.hatch, edgecolor=HATCH, lw=0.5, label=fill.name, alpha=alpha)


def shown(axes: Axes, points: Floats) -> bool:
    """Whether the box around some points (n, 2) overlaps what the axes show; NaN is nowhere."""
    low, high = np.sort([axes.get_xlim(), axes.get_ylim()]).T
    placed = points[np.isfinite(points).all(axis=1)]
    return bool(len(placed) and (placed.max(axis=0) > low).all() and (placed.min(axis=0) < high).all())


def seen_from(viewpoint: Pose, points: Floats) -> Floats:
    """Points (n, 2) [m] of the world as seen from there: ahead and left (n, 2)."""
    cos, sin = math.cos(viewpoint.yaw), math.sin(viewpoint.yaw)
    turned: Floats = (points - viewpoint[:2]) @ np.array([[cos, -sin], [sin, cos]])
    return turned
