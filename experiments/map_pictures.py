"""Maps beside one another over what is truly there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.simulator.world import Pose
from experiments import colours
from experiments.map_score import MapScore, edges_shown, faults, free, occupied
from experiments.map_truth import Ground
from experiments.panels import Panel
from experiments.sheet import write_sheet

UNKNOWN, FREE, OCCUPIED = "#BDBDBD", "#FFFFFF", "#000000"
WRONGLY_FREE, BLOCKED = "#F0A07A", "#D433A6"
SHOWN, LOST = colours.BLUE, "#E00000"
TITLES = {
    "positive": "Map of the positive scan (fig. 24)",
    "paper": "Map of the paper's combined scan (fig. 25)",
    "fused": "Map of the fused scan (ours)",
}
BESIDE = 0.3  # [m] shown around the floor plan

Pixels = NDArray[np.float64]


def map_picture(
    path: Path,
    maps: Mapping[str, OccupancyGrid],
    scores: Mapping[str, MapScore],
    ground: Ground,
    in_view: Floats,
    way: Sequence[Pose],
) -> Path:
    """Draw each map with its faults; in_view: the edges' points (n, 2) [m] that a map should show."""
    panels = [map_panel(grid, ground, in_view, way, title(name, scores[name])) for name, grid in maps.items()]
    text = "One drive on the landing, mapped from three scans, over the true outline"
    return write_sheet(path, text, panels, len(panels), legend(), 4.4)


def title(name: str, score: MapScore) -> str:
    """What a map is made of, and how good it is."""
    return (
        f"{TITLES.get(name, name)}\n{score.free_beyond:.2f} m² free beyond an edge, "
        f"{score.blocked:.2f} m² blocked wrongly,\n{100 * score.edges:.0f} % of the edges seen are on the map"
    )


def map_panel(grid: OccupancyGrid, ground: Ground, in_view: Floats, way: Sequence[Pose], text: str) -> Panel:
    """One map, north up as the world has it."""

    def draw(axes: Axes) -> None:
        left, bottom = grid.origin[:2]
        extent = (left, left + grid.width * grid.resolution, bottom, bottom + grid.height * grid.resolution)
        axes.set_facecolor(UNKNOWN)
        axes.imshow(pixels(grid, ground), origin="lower", extent=extent, interpolation="nearest")
        for outline in ground.outlines:
            if outline.kind == "obstacle":
                axes.add_patch(Polygon(outline.polygon, fill=False, edgecolor=colours.WALL, linewidth=0.7))
        shown = edges_shown(grid, in_view)
        axes.plot(*ground.edges.T, ".", color=colours.GREY, markersize=1.0)
        for chosen, colour in ((shown, SHOWN), (~shown, LOST)):
            axes.plot(*in_view[chosen].T, ".", color=colour, markersize=2.5, markeredgewidth=0.0)
        axes.plot(*np.array(way)[:, :2].T, color=colours.GREEN, linewidth=1.0)
        frame(axes, ground)
        axes.set_title(text, fontsize=9)

    return draw


def frame(axes: Axes, ground: Ground) -> None:
    """Show the whole floor plan."""
    corners = np.concatenate([outline.polygon for outline in ground.outlines])
    (left, bottom), (right, top) = corners.min(axis=0) - BESIDE, corners.max(axis=0) + BESIDE
    axes.set(xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal")


def pixels(grid: OccupancyGrid, ground: Ground) -> Pixels:
    """The map in colours: (height, width, 3)."""
    shape = grid.height, grid.width
    image = np.empty((*shape, 3))
    image[:] = to_rgb(UNKNOWN)
    wrong = faults(grid, ground)
    for chosen, colour in (
        (free(grid).reshape(shape), FREE),
        (occupied(grid).reshape(shape), OCCUPIED),
        (wrong.free_beyond, WRONGLY_FREE),
        (wrong.blocked, BLOCKED),
    ):
        image[chosen] = to_rgb(colour)
    return image


def legend() -> list[Artist]:
    """What the colours mean."""
    cells = {
        "free": FREE,
        "occupied": OCCUPIED,
        "unknown": UNKNOWN,
        "free beyond an edge": WRONGLY_FREE,
        "blocked wrongly": BLOCKED,
    }
    lines = {
        "true edge, on the map": SHOWN,
        "true edge, seen and not on it": LOST,
        "true edge, not seen": colours.GREY,
        "wall, post": colours.WALL,
        "the robot's way": colours.GREEN,
    }
    patches: list[Artist] = [Patch(facecolor=colour, edgecolor="#808080", label=name) for name, colour in cells.items()]
    return [*patches, *(Line2D([], [], color=colour, linewidth=2, label=name) for name, colour in lines.items())]
