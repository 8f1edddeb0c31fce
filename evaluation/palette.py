"""One colour for one meaning in all pictures.

The hues are those of Okabe and Ito, shifted so that their lightness differs too: what is shown together is told apart
by colour-blind eyes and in grey (tests/unit/evaluation/test_palette.py). Dots have a marker and lines a style besides.
"""

from typing import Final, Literal, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import ListedColormap

from cliffscan.common.contract.base_messages import Rule
from cliffscan.common.contract.evidence import Evidence
from cliffscan.simulator.truth import Kind as Piece
from evaluation.pictures.cloud import Kind
from evaluation.score import Verdict

BLACK, BLUE, VERMILLION, PURPLE, GREEN, YELLOW = "#000000", "#004488", "#BF4F00", "#CC79A7", "#66CC99", "#F0E442"
GREY, WHITE = "#8C8C8C", "#FFFFFF"
LIGHT = (GREEN, YELLOW)  # a dot of these has a black border, any other a white one

DEPTH = ListedColormap(colormaps["cividis"](np.linspace(0.25, 1.0, 256)), "depth")  # its darkest is not black
NO_RETURN = BLACK


class Mark(NamedTuple):
    """How a dot of one meaning looks, and what its legend says."""

    colour: str
    marker: str
    name: str


class Stroke(NamedTuple):
    """How a line of one meaning looks, and what its legend says."""

    colour: str
    style: Literal["solid", "dashed", "dotted", "dashdot"] | tuple[float, tuple[float, ...]]
    width: float
    name: str


class Fill(NamedTuple):
    """How an area of one meaning looks, and what its legend says."""

    colour: str
    name: str
    hatch: str = ""


KINDS = {
    Kind.NOTHING: Fill(NO_RETURN, "nothing in range"),
    Kind.BELOW: Fill(BLUE, "below the floor"),
    Kind.OBSTACLE: Fill(VERMILLION, "in the robot's way"),
    Kind.FLOOR: Fill(GREEN, "floor band"),
    Kind.OVERHEAD: Fill(YELLOW, "above the robot"),
}
EVIDENCE = {
    Evidence.POSITIVE: Mark(VERMILLION, "s", "positive obstacle"),
    Evidence.DROP: Mark(BLUE, "v", "drop seen"),
    Evidence.FARTHEST_FLOOR: Mark(GREEN, "o", "farthest floor point"),
    Evidence.FLOOR_LOST: Mark(PURPLE, "D", "floor lost"),
    Evidence.EXTRA: Mark(YELLOW, "P", "extra input"),
    Evidence.NOTHING: Mark(BLACK, "X", "no evidence told"),
}
PIECES: dict[Piece, Fill] = {  # of a world, seen from above
    "lower": Fill("#B9CDE5", "hole, lower ground"),
    "floor": Fill("#F4F4EF", "floor"),
    "obstacle": Fill("#404040", "wall, obstacle"),
    "overhead": Fill("#F3EBA6", "overhead: passed under", "...."),
}
GLOSSY = Fill("#DDDDDD", "no returns", "xxxx")
FREE_BEAM = Fill(GREEN, "free beam", "////")
CELLS = {  # of a map
    "occupied": Fill(BLACK, "occupied"),
    "blocked": Fill(PURPLE, "blocked wrongly"),
    "free_beyond": Fill("#F5A742", "free beyond an edge"),
    "unknown": Fill("#D9D9D9", "unknown"),
    "free": Fill(WHITE, "free"),
}
EDGE = Stroke(BLACK, "solid", 3.2, "true edge of the floor")
VIEW = Stroke(BLACK, (0, (4, 3)), 0.8, "field of view, reach")
EDGE_ASKED = Stroke(BLACK, "solid", 3.2, "edge that must be found")
EDGE_OTHER = Stroke(BLACK, "dotted", 1.5, "other edge")
RAMP = Stroke(GREY, "dashed", 1.5, "ramp begins or ends")
EDGE_SHOWN = Stroke(BLUE, "solid", 2.5, "true edge, on the map")
EDGE_LOST = Stroke(VERMILLION, (0, (3, 1.5)), 2.5, "true edge, seen and not on the map")
EDGE_UNSEEN = Stroke(GREY, "dotted", 1.5, "true edge, not seen")
WALL = Stroke(PIECES["obstacle"].colour, "solid", 0.7, "wall, obstacle")
WAY = Stroke("#117733", "dashdot", 1.3, "the robot's way")

VERDICTS = {
    Verdict.FOUND: Mark(GREEN, "o", "found"),
    Verdict.EARLY: Mark(YELLOW, "v", "early"),
    Verdict.LATE: Mark(PURPLE, "^", "late"),
    Verdict.MISSED: Mark(BLACK, "X", "missed, at its edge"),
    Verdict.FALSE: Mark(VERMILLION, "s", "false"),
    Verdict.ASTRAY: Mark(YELLOW, "D", "before what need not be found"),
    Verdict.UNCOUNTED: Mark(GREY, ".", "not counted"),
}
STANDS: Final = "dashed"
RULES: dict[Rule, Stroke] = {
    "free": Stroke(BLACK, "solid", 1.0, "free"),
    "limit": Stroke(GREY, "solid", 2.0, "limit"),
    "obstacle": Stroke(VERMILLION, "solid", 2.5, "obstacle"),
    "cliff": Stroke(BLUE, "dotted", 3.0, "cliff"),
    "bumper": Stroke(PURPLE, "dotted", 3.0, "bumper"),
    "odometry": Stroke(VERMILLION, STANDS, 2.0, "odometry"),
    "no_scan": Stroke(BLUE, STANDS, 2.0, "no_scan"),
    "no_command": Stroke(GREY, "dashdot", 2.0, "no_command"),
    "no_base": Stroke(BLACK, STANDS, 2.0, "no_base"),
    "refused": Stroke(BLACK, "dashdot", 2.0, "refused"),
    "stopped": Stroke(PURPLE, STANDS, 2.0, "stopped"),
    "wheel_drop": Stroke(GREEN, STANDS, 2.0, "wheel_drop"),
    "overcurrent": Stroke(YELLOW, STANDS, 2.0, "overcurrent"),
}
EVENTS = {
    "fall": Mark(BLACK, "X", "fall"),
    "cliff": Mark(BLUE, "^", "cliff sensor"),
    "bump": Mark(VERMILLION, "s", "bump"),
    "stranded": Mark(PURPLE, "P", "stranded"),
}
IDLE = Mark(YELLOW, "o", "held without cause")
UNVISITED = Fill("none", "not visited", "\\\\\\")
