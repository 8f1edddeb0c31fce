"""The single panels of the pictures, each drawn on axes that it is given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.simulator.truth import Outline
from experiments import colours
from experiments.cloud import Cloud, Kind
from experiments.known_world import angles_of
from experiments.plan_view import Extent, draw_field_of_view, draw_world, places, prepare

MOST_POINTS = 60_000  # more would only be drawn over one another
FEW_POINTS = 15_000  # so many are drawn larger, or they would be lost on the edge where they lie
DARKEST = 0.6  # brightness of the farthest pixel of the evidence

Panel = Callable[[Axes], None]


class Scene(NamedTuple):
    """What all panels from above show: how much of the floor, its field of view, and what is truly there, if known."""

    extent: Extent
    view: LaserScan
    outlines: Sequence[Outline] = ()

    def draw(self, axes: Axes) -> None:
        """The background of a panel from above."""
        prepare(axes, self.extent)
        axes.set_facecolor(colours.LOWER if self.outlines else "white")
        draw_world(axes, self.outlines)
        draw_field_of_view(axes, self.view)


def depth_panel(image: DepthImage, title: str) -> Panel:
    """The depth image in colours, with their scale."""

    def draw(axes: Axes) -> None:
        metres = np.where(image.depth > 0, image.depth * 0.001, np.nan)
        axes.set_facecolor("black")
        seen = metres[metres <= image.camera.range[1]]
        nearest, farthest = np.percentile(seen, (0.5, 99.5)) if seen.size else image.camera.range
        shown = axes.imshow(metres, cmap="turbo", vmin=nearest, vmax=farthest, interpolation="nearest")
        scale = axes.inset_axes((1.02, 0.0, 0.03, 1.0))
        Colorbar(scale, shown, label="depth [m], black: no return")
        _label_image(axes, title)

    return draw


def kind_panel(image: DepthImage, kinds: NDArray[np.uint8], title: str) -> Panel:
    """The depth image with each pixel in the colour of what it is, the darker the farther."""

    def draw(axes: Axes) -> None:
        palette = np.array([to_rgb(colours.OF_KIND[kind]) for kind in Kind])
        farthest = max(1000.0 * image.camera.range[1], 1.0)
        brightness = np.clip(1.0 - (1.0 - DARKEST) * image.depth / farthest, DARKEST, 1.0)
        axes.imshow(palette[kinds] * brightness[..., None], interpolation="nearest")
        _label_image(axes, title)

    return draw


def points_panel(scene: Scene, points: Cloud, kinds: NDArray[np.uint8], shown: Sequence[Kind], title: str) -> Panel:
    """The points from above: those of the kinds to be `shown` in their colours, over all others in grey."""

    def draw(axes: Axes) -> None:
        scene.draw(axes)
        others = [kind for kind in Kind if kind not in (*shown, Kind.NOTHING)]
        _scatter(axes, points, np.isin(kinds, others), colours.GREY, 0.25)
        for kind in shown:
            _scatter(axes, points, kinds == kind, colours.OF_KIND[kind], 0.6)
        number, total = np.isin(kinds, shown).sum(), (kinds != Kind.NOTHING).sum()
        _title(axes, title, f"{number:,} of {total:,} points" if others else f"{total:,} points")

    return draw


def scan_panel(
    scene: Scene, scan: LaserScan, title: str, behind: tuple[Cloud, NDArray[np.uint8]] | None = None
) -> Panel:
    """A scan's numbers in the colours of their evidence, its free beams green; `behind` it the points, if given."""

    def draw(axes: Axes) -> None:
        scene.draw(axes)
        _draw_free(axes, scan)
        if behind:
            points, kinds = behind
            for kind in (Kind.OVERHEAD, Kind.OBSTACLE, Kind.FLOOR, Kind.BELOW):
                _scatter(axes, points, kinds == kind, colours.OF_KIND[kind], 0.12)
        x, y = places(scan)
        told = (scan.intensities if len(scan.intensities) else np.zeros(len(scan.ranges)))[np.isfinite(scan.ranges)]
        for evidence, colour in colours.OF_EVIDENCE.items():
            chosen = told == evidence
            axes.plot(y[chosen], x[chosen], ".", color=colour, markersize=4.0, zorder=5)
        free, unseen = int(np.isposinf(scan.ranges).sum()), int(np.isnan(scan.ranges).sum())
        _title(axes, title, f"{x.size} numbers · {free} free · {unseen} not seen")

    return draw


def _draw_free(axes: Axes, scan: LaserScan) -> None:
    """Fill each run of neighbouring free beams as one wedge."""
    free = np.flatnonzero(np.isposinf(scan.ranges))
    half = scan.angle_increment / 2
    for run in np.split(free, np.flatnonzero(np.diff(free) > 1) + 1):
        if run.size:
            angles = np.array([angles_of(scan)[run[0]] - half, *angles_of(scan)[run], angles_of(scan)[run[-1]] + half])
            x, y = scan.range_max * np.cos(angles), scan.range_max * np.sin(angles)
            axes.fill([0.0, *y], [0.0, *x], color=colours.FREE, alpha=0.35, linewidth=0.0, zorder=2)


def _scatter(axes: Axes, points: Cloud, chosen: NDArray[np.bool_], colour: str, alpha: float) -> None:
    x, y = points.ahead[chosen], points.left[chosen]
    stride = max(1, x.size // MOST_POINTS + 1)
    size = 1.2 if x.size > FEW_POINTS else 3.0
    axes.plot(y[::stride], x[::stride], ".", color=colour, alpha=alpha, markersize=size, markeredgewidth=0.0, zorder=3)


def _label_image(axes: Axes, title: str) -> None:
    axes.set_xlabel("u [px]")
    axes.set_ylabel("v [px]")
    _title(axes, title)


def _title(axes: Axes, title: str, below: str = "") -> None:
    axes.set_title(f"{title}\n{below}" if below else title, fontsize=10)
