"""The scene from above: robot, field of view, and what is truly there, in the robot's frame with its heading up."""

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


class Plot:
    """Axes to draw on, and the legend of what was drawn: by name what each meaning looks like, if the axes show it."""

    def __init__(self, axes: Axes) -> None:
        self.axes = axes
        self.legend: dict[str, Artist] = {}

    def area(self, corners: Floats, fill: Fill, layer: float, alpha: float | None = None) -> None:
        """Fill a polygon (n, 2)."""
        patch = Polygon(corners, facecolor=fill.colour, hatch=fill.hatch, lw=0.0, zorder=layer, alpha=alpha)
        patch.set_edgecolor(HATCH if fill.hatch else "none")
        self.axes.add_patch(patch)
        if self.shows(corners):
            self.swatch(fill, alpha)

    def line(self, points: Floats, how: Stroke, layer: float) -> None:
        """Draw a line through points (n, 2), with gaps at NaN."""
        self.axes.plot(*points.T, color=how.colour, linestyle=how.style, linewidth=how.width, zorder=layer)
        if self.shows(points):
            entry = Line2D([], [], color=how.colour, linestyle=how.style, linewidth=how.width, label=how.name)
            self.legend[how.name] = entry

    def dots(self, points: Floats, how: Mark, layer: float, every: int = 1) -> None:
        """Draw points (n, 2), of each `every` one with its marker, the others small."""
        if not self.shows(points):
            return
        if every > 1:
            self.axes.plot(*points.T, ".", color=how.colour, ms=4.0, zorder=layer)
        marks = Line2D(*points[every // 2 :: every].T, zorder=layer + 0.1)
        entry = self.legend[how.name] = Line2D([], [], label=how.name)
        border = palette.BLACK if how.colour in palette.LIGHT else palette.WHITE
        for each in (marks, entry):
            each.set(color=how.colour, marker=how.marker, ms=5.5, linestyle="none", mec=border, mew=0.5)
        self.axes.add_line(marks)

    def swatch(self, fill: Fill, alpha: float | None = None) -> None:
        """Have an area in the legend."""
        self.legend[fill.name] = Patch(
            facecolor=fill.colour, hatch=fill.hatch, edgecolor=HATCH, lw=0.5, label=fill.name, alpha=alpha
        )

    def shows(self, points: Floats) -> bool:
        """Whether the box around some points (n, 2) overlaps what the axes show; NaN is nowhere."""
        low, high = np.sort([self.axes.get_xlim(), self.axes.get_ylim()]).T
        placed = points[np.isfinite(points).all(axis=1)]
        return bool(len(placed) and (placed.max(axis=0) > low).all() and (placed.min(axis=0) < high).all())


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


def draw_field_of_view(plot: Plot, scan: LaserScan) -> None:
    """The first and the last beam, and how far the sensor reaches."""
    angles = np.linspace(scan.angle_min, scan.angle_max, 60)
    x, y = scan.range_max * np.cos(angles), scan.range_max * np.sin(angles)
    plot.line(np.array([[0.0, *y, 0.0], [0.0, *x, 0.0]]).T, palette.VIEW, 4.0)


def draw_pieces(plot: Plot, pieces: Iterable[Outline], upward: bool) -> None:
    """What is truly there. upward: (left, ahead) is plotted."""
    for piece in pieces:
        corners = piece.polygon[:, ::-1] if upward else piece.polygon
        plot.area(corners, palette.PIECES[piece.kind], LAYER[piece.kind])


def draw_edge(plot: Plot, pieces: Iterable[Outline]) -> None:
    """The borders of all floor, where (left, ahead) is plotted; pieces that draw_pieces fills hide the seams."""
    for piece in pieces:
        if piece.kind == "floor":
            plot.line(piece.polygon[:, ::-1], palette.EDGE, 1.1)
