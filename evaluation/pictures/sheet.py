"""A picture of several panels with one legend of what is in them, written as PNG."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evaluation.pictures.plan import Plot

WIDTH, HEIGHT = 5.4, 4.9  # [inch] of a panel from above
IMAGE_HEIGHT = 4.0  # [inch] of a panel that shows an image
DPI = 100
ENTRY = 2.0  # [inch] of the legend

Panel = Callable[[Plot], None]


def write_sheet(
    path: Path, title: str, panels: Sequence[Panel], columns: int, height: float = HEIGHT, width: float = WIDTH
) -> Path:
    """Draw the panels, row by row, each of that size [inch], and write the picture; returns its path."""
    sheet(title, panels, columns, height, width).savefig(path)
    return path


def sheet(title: str, panels: Sequence[Panel], columns: int, height: float = HEIGHT, width: float = WIDTH) -> Figure:
    """The picture, each entry of the legend once."""
    rows = math.ceil(len(panels) / columns)
    figure = Figure(figsize=(width * columns, height * rows + 0.9), dpi=DPI, layout="constrained")
    figure.suptitle(title, fontsize=13)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    legend: dict[str, Artist] = {}
    for axes, panel in zip(grid, panels, strict=False):
        plot = Plot(axes)
        panel(plot)
        legend |= plot.legend
    for axes in grid[len(panels) :]:
        axes.set_axis_off()
    figure.legend(
        handles=list(legend.values()),
        loc="outside lower center",
        ncols=round(width * columns / ENTRY),
        fontsize=9,
        frameon=False,
    )
    return figure


def label(axes: Axes, title: str, below: str = "") -> None:
    """Name a panel, with a smaller line below the name."""
    axes.set_title(f"{title}\n{below}" if below else title, fontsize=10)
