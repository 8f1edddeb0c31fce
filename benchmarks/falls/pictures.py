"""A picture of a run: the world from above, the robot's way by the gate's rules, and what happened."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.patches import Circle

from benchmarks.falls.floor import CELL, NEAR, Floor, dilated
from benchmarks.falls.log import Outcome, Point
from cliffscan.simulator.truth import outlines
from cliffscan.simulator.world import World
from evaluation import palette
from evaluation.pictures.plan import Plot, draw_pieces
from evaluation.pictures.sheet import write_sheet
from evaluation.tables import unique

AROUND = 0.3  # [m] shown around the floor plan
SIZE = 8.0, 12.0  # [inch] high and wide


def draw(outcome: Outcome, track: Sequence[Point], world: World, radius: float, path: Path) -> None:
    """Write the picture of a run; radius: [m] of the disc that the robot needs."""

    def panel(plot: Plot) -> None:
        floor, axes = Floor(world, radius), plot.axes
        (left, near), (right, far) = floor.low - AROUND, floor.high + AROUND
        axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", xlim=(left, right), ylim=(near, far))
        axes.set_facecolor(palette.PIECES["lower"].colour)
        draw_pieces(plot, outlines(world), upward=False)
        unvisited(plot, floor, track)
        way(plot, track)
        for kind, mark in palette.EVENTS.items():
            found = np.array([event[2:4] for event in outcome.events if event.kind == kind]).reshape(-1, 2)
            plot.dots(found, mark._replace(name=f"{mark.name}: {len(found)}"), 5.0)
        axes.add_patch(Circle(track[-1][1:3], radius, fill=False, lw=2, zorder=6.0))

    told = f"{outcome.seconds:.0f} s, {outcome.visited:.0%} visited, {outcome.idle:.0f} s idle"
    write_sheet(path, f"{outcome.case.name}: {told}", [panel], 1, *SIZE)


def unvisited(plot: Plot, floor: Floor, track: Sequence[Point]) -> None:
    """Hatch the reachable floor where the robot never was."""
    missed = floor.reachable & ~dilated(floor.mask(np.array([point[1:3] for point in track])), NEAR / CELL)
    if not missed.any():
        return
    middles = (low + CELL * (0.5 + np.arange(count)) for low, count in zip(floor.low, missed.shape, strict=True))
    hatch = palette.UNVISITED.hatch
    plot.axes.contourf(*middles, missed.T, levels=[0.5, 1.5], colors="none", hatches=[hatch], zorder=1.25)
    plot.swatch(palette.UNVISITED)


def way(plot: Plot, track: Sequence[Point]) -> None:
    """The track, a line for each rule; dots where the robot was held without cause."""
    places = np.array([point[1:3] for point in track])
    rules = np.array([point.rule for point in track])
    for rule in unique(point.rule for point in track[1:]):
        of_rule = rules == rule
        before = np.append(of_rule[1:], False)  # a piece of the way has the rule of its end
        piece = np.where((of_rule | before)[:, None], places, np.nan)
        plot.line(piece, palette.RULES[rule], 3.0)
    idle = places[[point.idle for point in track]]
    plot.dots(idle, palette.IDLE, 4.0)
