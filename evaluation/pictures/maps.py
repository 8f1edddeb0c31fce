"""Maps beside one another over what is truly there."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.simulator.world import Pose
from evaluation import palette
from evaluation.map_score import edges_shown, faults, free, occupied
from evaluation.pictures.plan import Plot
from evaluation.pictures.sheet import Panel
from evaluation.truth.world_truth import SPACING, Ground, nearest

BESIDE = 0.3  # [m] shown around the floor plan


def map_panel(grid: OccupancyGrid, ground: Ground, in_view: Floats, way: Sequence[Pose], text: str) -> Panel:
    """One map, north up as the world has it; in_view: the edges' points (n, 2) [m] that it should show."""

    def draw(plot: Plot) -> None:
        axes = plot.axes
        left, bottom = grid.origin[:2]
        extent = (left, left + grid.width * grid.resolution, bottom, bottom + grid.height * grid.resolution)
        axes.set_facecolor(palette.CELLS["unknown"].colour)
        cells = cells_of(grid, ground)
        colours = np.array([to_rgb(fill.colour) for fill in palette.CELLS.values()])
        axes.imshow(colours[cells], origin="lower", extent=extent, interpolation="nearest")
        show_all(axes, ground)
        for place, fill in enumerate(palette.CELLS.values()):
            if (cells == place).any():
                plot.swatch(fill)
        for outline in ground.outlines:
            if outline.kind == "obstacle":
                plot.line(outline.polygon, palette.WALL, 2.0)
        seen = edges_shown(grid, in_view)
        unseen = ground.edges[nearest(ground.edges, in_view) > SPACING / 2]
        for points, how in (
            (unseen, palette.EDGE_UNSEEN),
            (in_view[~seen], palette.EDGE_LOST),
            (in_view[seen], palette.EDGE_SHOWN),
        ):
            _border(plot, points, how)
        plot.line(np.array(way)[:, :2], palette.WAY, 4.0)
        axes.set_title(text, fontsize=9)

    return draw


def cells_of(grid: OccupancyGrid, ground: Ground) -> NDArray[np.int64]:
    """What each cell is, as a place in palette.CELLS: (height, width)."""
    shape = grid.height, grid.width
    wrong = faults(grid, ground)
    is_ = {"free": free(grid).reshape(shape), "occupied": occupied(grid).reshape(shape)} | wrong._asdict()
    names = list(palette.CELLS)
    conditions = {name: is_[name] for name in ("blocked", "free_beyond", "occupied", "free")}
    places = np.select(list(conditions.values()), [names.index(name) for name in conditions], names.index("unknown"))
    return places.astype(np.int64)


def show_all(axes: Axes, ground: Ground) -> None:
    """Show the whole floor plan."""
    corners = np.concatenate([outline.polygon for outline in ground.outlines])
    (left, bottom), (right, top) = corners.min(axis=0) - BESIDE, corners.max(axis=0) + BESIDE
    axes.set(xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal")


def _border(plot: Plot, points: Floats, how: palette.Stroke) -> None:
    """A line through points (n, 2) [m] of edges, with a gap wherever one is farther than SPACING from the last."""
    if not len(points):
        return
    gaps = np.flatnonzero(np.hypot(*np.diff(points, axis=0).T) > 2 * SPACING) + 1
    pieces = np.insert(points, gaps, np.nan, axis=0)
    plot.axes.plot(*pieces.T, color="white", linewidth=how.width + 0.8, zorder=3.0)
    plot.line(pieces, how, 3.1)
