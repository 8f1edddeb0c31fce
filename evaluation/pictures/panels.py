"""The single panels of the pictures, each drawn on the plot that it is given."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.simulator.truth import Outline
from evaluation import palette
from evaluation.pictures.cloud import Cloud, Kind
from evaluation.pictures.plan import Extent, Plot, draw_edge, draw_field_of_view, draw_pieces, places, prepare
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

    def draw(self, plot: Plot) -> None:
        """The background of a panel from above."""
        prepare(plot.axes, self.extent)
        plot.axes.set_facecolor(palette.PIECES["lower"].colour if self.outlines else "white")
        draw_edge(plot, self.outlines)
        draw_pieces(plot, self.outlines, upward=True)
        draw_field_of_view(plot, self.view)


def depth_panel(image: DepthImage, title: str) -> Panel:
    """The depth image in colours, with their scale."""

    def draw(plot: Plot) -> None:
        metres = np.where(image.depth > 0, image.depth * 0.001, np.nan)
        plot.axes.set_facecolor(palette.NO_RETURN)
        seen = metres[metres <= image.camera.range[1]]
        nearest, farthest = np.percentile(seen, (0.5, 99.5)) if seen.size else image.camera.range
        drawn = plot.axes.imshow(metres, cmap=palette.DEPTH, vmin=nearest, vmax=farthest, interpolation="nearest")
        Colorbar(plot.axes.inset_axes((1.02, 0.0, 0.03, 1.0)), drawn, label="depth [m], black: no return")
        _label_image(plot.axes, title)

    return draw


def kind_panel(kinds: NDArray[np.uint8], title: str) -> Panel:
    """The depth image with each pixel in the colour of what it is."""

    def draw(plot: Plot) -> None:
        colours = np.array([to_rgb(palette.KINDS[kind].colour) for kind in Kind])
        plot.axes.imshow(colours[kinds], interpolation="nearest")
        _label_image(plot.axes, title)
        for kind in np.unique(kinds):
            plot.swatch(palette.KINDS[Kind(kind)])

    return draw


def points_panel(scene: Scene, points: Cloud, kinds: NDArray[np.uint8], shown: Sequence[Kind], title: str) -> Panel:
    """The points from above: those of the kinds to be `shown` in their colours, over all others in grey."""

    def draw(plot: Plot) -> None:
        scene.draw(plot)
        others = np.isin(kinds, [kind for kind in Kind if kind not in (*shown, Kind.NOTHING)])
        _scatter(plot, points, others, palette.Fill(palette.GREY, "any other point"), 0.25)
        for kind in shown:
            _scatter(plot, points, kinds == kind, palette.KINDS[kind], 0.6)
        number, total = np.isin(kinds, shown).sum(), (kinds != Kind.NOTHING).sum()
        label(plot.axes, title, f"{number:,} of {total:,} points" if others.any() else f"{total:,} points")

    return draw


def scan_panel(
    scene: Scene, scan: LaserScan, title: str, behind: tuple[Cloud, NDArray[np.uint8]] | None = None
) -> Panel:
    """A scan's numbers by their evidence, its free beams as wedges; `behind` it the points, if given."""

    def draw(plot: Plot) -> None:
        scene.draw(plot)
        _draw_free(plot, scan)
        if behind:
            points, kinds = behind
            for kind in (Kind.OVERHEAD, Kind.OBSTACLE, Kind.FLOOR, Kind.BELOW):
                _scatter(plot, points, kinds == kind, palette.KINDS[kind], 0.12)
        x, y = places(scan)
        told = (scan.intensities if len(scan.intensities) else np.zeros(len(scan.ranges)))[np.isfinite(scan.ranges)]
        for evidence, mark in palette.EVIDENCE.items():
            chosen = told == evidence
            plot.dots(np.column_stack([y, x])[chosen], mark, 5.0, EVERY)
        free, unseen = int(np.isposinf(scan.ranges).sum()), int(np.isnan(scan.ranges).sum())
        label(plot.axes, title, f"{x.size} numbers · {free} free · {unseen} not seen")

    return draw


def _draw_free(plot: Plot, scan: LaserScan) -> None:
    """Fill each run of neighbouring free beams as one wedge."""
    free = np.flatnonzero(np.isposinf(scan.ranges))
    for run in np.split(free, np.flatnonzero(np.diff(free) > 1) + 1) if free.size else ():
        borders = scan.angle_min + scan.angle_increment * np.array([run[0] - 0.5, *run, run[-1] + 0.5])
        arc = scan.range_max * np.column_stack([np.sin(borders), np.cos(borders)])
        plot.area(np.vstack([np.zeros((1, 2)), arc]), palette.FREE_BEAM, 2.0, WEDGE)


def _scatter(plot: Plot, points: Cloud, chosen: NDArray[np.bool_], fill: palette.Fill, alpha: float) -> None:
    x, y = points.ahead[chosen], points.left[chosen]
    stride = max(1, x.size // MOST_POINTS + 1)
    size = 1.2 if x.size > FEW_POINTS else 3.0
    plot.axes.plot(y[::stride], x[::stride], ".", color=fill.colour, alpha=alpha, ms=size, mew=0.0, zorder=3)
    if plot.shows(np.column_stack([y, x])):
        plot.swatch(fill)


def _label_image(axes: Axes, title: str) -> None:
    axes.set_xlabel("u [px]")
    axes.set_ylabel("v [px]")
    label(axes, title)
