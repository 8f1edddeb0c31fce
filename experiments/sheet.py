"""A picture of several panels with one legend, written as PNG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from cliffscan.common.contract.evidence import Evidence
from experiments import colours
from experiments.cloud import Kind
from experiments.panels import Panel

WIDTH, HEIGHT = 5.4, 4.9  # [inch] of a panel from above
IMAGE_HEIGHT = 4.0  # [inch] of a panel that shows an image
DPI = 100


def write_sheet(
    path: Path, title: str, panels: Sequence[Panel], columns: int, legend: Sequence[Artist], height: float = HEIGHT
) -> Path:
    """Draw the panels, row by row, each `height` [inch] high, and write the picture; returns its path."""
    rows = math.ceil(len(panels) / columns)
    figure = Figure(figsize=(WIDTH * columns, height * rows + 0.9), dpi=DPI, layout="constrained")
    figure.suptitle(title, fontsize=13)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, panel in zip(grid, panels, strict=False):
        panel(axes)
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    figure.legend(handles=list(legend), loc="outside lower center", ncols=6, fontsize=9, frameon=False)
    figure.savefig(path)
    return path


def kind_legend(kinds: Sequence[Kind]) -> list[Artist]:
    """What the colours of pixels and points mean."""
    return [Patch(color=colours.OF_KIND[kind], label=colours.KIND_NAMES[kind]) for kind in kinds]


def evidence_legend(evidence: Sequence[Evidence]) -> list[Artist]:
    """What the colours of a scan's numbers mean."""
    dots: list[Artist] = [_dot(colours.OF_EVIDENCE[each], colours.EVIDENCE_NAMES[each]) for each in evidence]
    return [
        *dots,
        Patch(color=colours.FREE, alpha=0.35, label="free beam"),
        _line("field of view, reach", (0, (4, 3)), 0.8),
    ]


def world_legend() -> list[Artist]:
    """What is truly there."""
    return [
        _line("true edge of the floor", "solid", 2.0),
        Patch(color=colours.FLOOR, label="floor"),
        Patch(color=colours.LOWER, label="hole, lower ground"),
        Patch(color=colours.WALL, label="wall, obstacle"),
        Patch(color=colours.OVERHEAD, label="overhead: passed under"),
    ]


def _dot(colour: str, label: str) -> Line2D:
    return Line2D([], [], color=colour, marker="o", markersize=5, linestyle="none", label=label)


def _line(label: str, style: object, width: float) -> Line2D:
    return Line2D([], [], color="black", linestyle=style, linewidth=width, label=label)  # type: ignore[arg-type]
