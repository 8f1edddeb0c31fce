"""The single panels of the pictures, each drawn on axes that it is given; each returns its legend."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.simulator.truth import Outline
from evaluation import palette
from evaluation.pictures.cloud import Cloud, Kind
from evaluation.pictures.plan import (
    Extent,
    area,
    dots,
    draw_edge,
    draw_field_of_view,
    draw_pieces,
    places,
    prepare,
    swatch,
)
from evaluation.pictures.plan import shown as within
from evaluation.pictures.sheet import Panel, label

MOST_POINTS = 60_000  # more would only be drawn over one another
FEW_POINTS = 15_000  # so many are drawn larger, or they would be lost on the edge where they lie
EVERY = 24  # of the beams, one in so many shows the marker of its evidence
WEDGE = 0.35  # opacity of free beams


class Scene(NamedTuple):
    """What all panels from above show: how much of the floor, its field of view, and what is truly there, if known."""

    extent: Extent
    view: LaserScan
    outlines: Sequence[Outline] = ()

    def draw(self, axes: Axes) -> list[Artist]:
        """The background of a panel from above; returns the legend."""
        prepare(axes, self.extent)
        axes.set_facecolor(palette.PIECES["lower"].colour if self.outlines else "white")
        edge = draw_edge(axes, self.outlines)
        return [*edge, *draw_pieces(axes, self.outlines, upward=True), *draw_field_of_view(axes, self.view)]


def depth_panel(image: DepthImage, title: str) -> Panel:
    """The depth image in colours, with their scale."""

    def draw(axes: Axes) -> list[Artist]:
        metres = np.where(image.depth > 0, image.depth * 0.001, np.nan)
        axes.set_facecolor(palette.NO_RETURN)
        seen = metres[metres <= image.camera.range[1]]
        nearest, farthest = np.percentile(seen, (0.5, 99.5)) if seen.size else image.camera.range
        drawn = axes.imshow(metres, cmap=palette.DEPTH, vmin=nearest, vmax=farthest, interpolation="nearest")
        Colorbar(axes.inset_axes((1.02, 0.0, 0.03, 1.0)), drawn, label="depth [m], black: no return")
        _label_image(axes, title)
        return []

    return draw


def kind_panel(kinds: NDArray[np.uint8], title: str) -> Panel:
    """The depth image with each pixel in the colour of what it is."""

    def draw(axes: Axes) -> list[Artist]:
        colours = np.array([to_rgb(palette.KINDS[kind].colour) for kind in Kind])
        axes.imshow(colours[kinds], interpolation="nearest")
        _label_image(axes, title)
        return [swatch(palette.KINDS[kind]) for kind in Kind if (kinds == kind).any()]

    return draw


def points_panel(scene: Scene, points: Cloud, kinds: NDArray[np.uint8], shown: Sequence[Kind], title: str) -> Panel:
    """The points from above: those of the kinds to be `shown` in their colours, over all others in grey."""

    def draw(axes: Axes) -> list[Artist]:
        legend = scene.draw(axes)
        others = np.isin(kinds, [kind for kind in Kind if kind not in (*shown, Kind.NOTHING)])
        legend += _scatter(axes, points, others, palette.Fill(palette.GREY, "any other point"), 0.25)
        for kind in shown:
            legend += _scatter(axes, points, kinds == kind, palette.KINDS[kind], 0.6)
        number, total = np.isin(kinds, shown).sum(), (kinds != Kind.NOTHING).sum()
        label(axes, title, f"{number:,} of {total:,} points" if others.any() else f"{total:,} points")
        return legend

    return draw


def scan_panel(
    scene: Scene, scan: LaserScan, title: str, behind: tuple[Cloud, NDArray[np.uint8]] | None = None
) -> Panel:
    """A scan's numbers by their evidence, its free beams as wedges; `behind` it the points, if given."""

    def draw(axes: Axes) -> list[Artist]:
        legend = [*scene.draw(axes), *_draw_free(axes, scan)]
        if behind:
            points, kinds = behind
            for kind in (Kind.OVERHEAD, Kind.OBSTACLE, Kind.FLOOR, Kind.BELOW):
                legend += _scatter(axes, points, kinds == kind, palette.KINDS[kind], 0.12)
        x, y = places(scan)
        told = (scan.intensities if len(scan.intensities) else np.zeros(len(scan.ranges)))[np.isfinite(scan.ranges)]
        for evidence, mark in palette.EVIDENCE.items():
            chosen = told == evidence
            legend += dots(axes, np.column_stack([y, x])[chosen], mark, 5.0, EVERY)
        free, unseen = int(np.isposinf(scan.ranges).sum()), int(np.isnan(scan.ranges).sum())
        label(axes, title, f"{x.size} numbers · {free} free · {unseen} not seen")
        return legend

    return draw


def _draw_free(axes: Axes, scan: LaserScan) -> list[Artist]:
    """Fill each run of neighbouring free beams as one wedge."""
    free = np.flatnonzero(np.isposinf(scan.ranges))
    legend: list[Artist] = []
    for run in np.split(free, np.flatnonzero(np.diff(free) > 1) + 1) if free.size else ():
        borders = scan.angle_min + scan.angle_increment * np.array([run[0] - 0.5, *run, run[-1] + 0.5])
        arc = scan.range_max * np.column_stack([np.sin(borders), np.cos(borders)])
        legend += area(axes, np.vstack([np.zeros((1, 2)), arc]), palette.FREE_BEAM, 2.0, WEDGE)
    return legend


def _scatter(axes: Axes, points: Cloud, chosen: NDArray[np.bool_], fill: palette.Fill, alpha: float) -> list[Artist]:
    x, y = points.ahead[chosen], points.left[chosen]
    stride = max(1, x.size // MOST_POINTS + 1)
    size = 1.2 if x.size > FEW_POINTS else 3.0
    axes.plot(y[::stride], x[::stride], ".", color=fill.colour, alpha=alpha, ms=size, markeredgewidth=0.0, zorder=3)
    return [swatch(fill)] if within(axes, np.column_stack([y, x])) else []


def _label_image(axes: Axes, title: str) -> None:
    axes.set_xlabel("u [px]")
    axes.set_ylabel("v [px]")
    label(axes, title)
