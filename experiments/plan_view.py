"""The scene from above: robot, field of view, and what is truly there, in the robot's frame with its heading up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from matplotlib.ticker import MaxNLocator

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.messages import LaserScan
from cliffscan.simulator.truth import Outline
from experiments import colours
from experiments.cloud import Cloud
from experiments.known_world import angles_of

ROBOT = 0.177  # [m] radius of a TurtleBot 2
FILLS = {"lower": colours.LOWER, "floor": colours.FLOOR, "obstacle": colours.WALL, "overhead": colours.OVERHEAD}
TICKS = 6  # intervals between the labels aside
MARGIN = 1.15
LEAST = 1.0  # [m] ahead that is shown at least
NARROWEST = 0.55  # aside, as a share of ahead: what fills a panel
MOST = 99.5  # [%] of the numbers that must be within the picture: the rest are stray


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
    angles, ranges = angles_of(scan)[reported], scan.ranges[reported].astype(np.float64)
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


def draw_field_of_view(axes: Axes, scan: LaserScan) -> None:
    """The first and the last beam, and how far the sensor reaches."""
    angles = np.linspace(scan.angle_min, scan.angle_max, 60)
    x, y = scan.range_max * np.cos(angles), scan.range_max * np.sin(angles)
    axes.plot([0, *y, 0], [0, *x, 0], color="black", linewidth=0.8, linestyle=(0, (4, 3)), zorder=4)


def draw_world(axes: Axes, outlines: Sequence[Outline]) -> None:
    """What is truly there: lower ground, floor with its edge as a black line, obstacles."""
    for outline in outlines:  # pieces of floor hide each other's seams when they are filled below, but not the edge
        if outline.kind == "floor":
            _add(axes, outline, 1.1, edge=3.2)
    for outline in outlines:
        _add(axes, outline, {"lower": 1.0, "floor": 1.2}.get(outline.kind, 1.3), fill=FILLS[outline.kind])


def _add(axes: Axes, outline: Outline, zorder: float, fill: str = "none", edge: float = 0.0) -> None:
    left_ahead = outline.polygon[:, ::-1]
    line = colours.EDGE if edge else "none"
    axes.add_patch(Polygon(left_ahead, facecolor=fill, edgecolor=line, linewidth=edge, zorder=zorder))
