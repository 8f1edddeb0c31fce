"""A picture of a run: the world from above, the robot's way in the colours of the gate's rules, and what happened."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from benchmarks.falls.floor import CELL, NEAR, RADIUS, Floor, dilated
from benchmarks.falls.outcome import Outcome, Point
from cliffscan.simulator.truth import outlines
from cliffscan.simulator.world import World

GROUND = {"lower": "mistyrose", "floor": "honeydew", "obstacle": "dimgray", "overhead": "none"}
RULES = {
    "free": "tab:green",
    "limit": "tab:olive",
    "obstacle": "tab:orange",
    "cliff": "red",
    "bumper": "magenta",
    "wheel_drop": "darkred",
    "no_scan": "tab:blue",
    "no_command": "tab:cyan",
    "no_base": "black",
}
IDLE = "blue"
AROUND = 0.3  # [m] shown around the floor plan
MARKS = {"fall": "rX", "cliff": "r^", "bump": "ms", "stranded": "kP"}


def draw(outcome: Outcome, track: list[Point], world: World, path: Path) -> None:
    """Write the picture of a run."""
    figure = Figure(figsize=(12.0, 9.0), layout="constrained")
    axes = figure.add_subplot()
    ground(axes, world)
    floor = Floor(world)
    unvisited(axes, floor, track)
    way(axes, track)
    for kind, mark in MARKS.items():
        found = [event for event in outcome.events if event.kind == kind]
        if found:
            axes.plot([e.x for e in found], [e.y for e in found], mark, ms=9, label=f"{kind}: {len(found)}")
    last = track[-1]
    axes.add_patch(Circle((last.x, last.y), RADIUS, fill=False, lw=2))
    (left, near), (right, far) = floor.low - AROUND, floor.high + AROUND
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title=title(outcome), xlim=(left, right), ylim=(near, far))
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    figure.savefig(path, dpi=80)


def title(outcome: Outcome) -> str:
    """The run's figures in a line."""
    return f"{outcome.case.name}: {outcome.seconds:.0f} s, {outcome.visited:.0%} visited, {outcome.idle:.0f} s idle"


def ground(axes: Axes, world: World) -> None:
    """Floor, what lies lower, and obstacles; where nothing is drawn it is deep."""
    abyss, *rest = outlines(world)
    for piece in rest if abyss.kind == "lower" else [abyss, *rest]:
        edge = "gray" if piece.kind == "overhead" else "none" if piece.kind == "floor" else "dimgray"
        axes.add_patch(Polygon(piece.polygon, facecolor=GROUND[piece.kind], edgecolor=edge, lw=0.6))


def unvisited(axes: Axes, floor: Floor, track: list[Point]) -> None:
    """Hatch the reachable floor where the robot never was."""
    missed = floor.reachable & ~dilated(floor.mask(np.array([point[1:3] for point in track])), NEAR / CELL)
    left, near = floor.low
    right, far = floor.low + CELL * np.array(missed.shape)
    shown = np.ma.masked_equal(missed.T.astype(float), 0.0)
    axes.imshow(shown, origin="lower", extent=(left, right, near, far), cmap="cool", alpha=0.25, zorder=1)


def way(axes: Axes, track: list[Point]) -> None:
    """The track, a colour for each rule; dots where the robot was held without cause."""
    places = np.array([point[1:3] for point in track])
    pieces = np.stack([places[:-1], places[1:]], axis=1)
    rules = [point.rule for point in track[1:]]
    for rule in dict.fromkeys(rules):
        of_rule = pieces[[each == rule for each in rules]]
        axes.add_collection(LineCollection(list(of_rule), colors=RULES.get(rule, "black"), label=rule, lw=1.2))
    idle = places[[point.idle for point in track]]
    if len(idle):
        axes.plot(*idle.T, ".", color=IDLE, ms=4, label="held without cause")
