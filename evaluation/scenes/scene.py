"""A scene: the faces that are drawn, and beside them what they mean, from which the truth is computed.

Coordinates [m] are those of the scan frame: the origin on the floor below the camera, x ahead, y left, z up.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.faces import at, circle, prism, sides
from cliffscan.simulator.kinect import KinectModel
from cliffscan.simulator.truth import BODY, Outline
from evaluation.scenes.polygons import around, rectangle

GROUND = rectangle(np.array([6.0, 0.0]), 16.0, 20.0, 0.0)  # farther than any sensor sees
TALL = 2.5  # [m] of a wall
GRAZING = KinectModel().grazing


class Obstacle(NamedTuple):
    """An upright prism: its outline (n, 2) [m] and the heights between which it stands [m]."""

    outline: Floats
    bottom: float
    top: float


class Drop(NamedTuple):
    """Where the floor is missing: its outline (n, 2) [m], and how far down it goes [m], inf = no bottom."""

    outline: Floats
    depth: float


class Ramp(NamedTuple):
    """A slope over the whole width: the floor rises by `slope` from `start` to `start + length` [m] along `heading`."""

    heading: float  # [rad]
    start: float  # [m]
    length: float  # [m]
    slope: float  # rise over run; down is negative


@dataclass
class Scene:
    """Faces (corners, 3) [m], counter-clockwise seen from outside, and what they mean."""

    faces: list[Floats] = field(default_factory=list)
    drops: list[Drop] = field(default_factory=list)
    obstacles: list[Obstacle] = field(default_factory=list)
    ramp: Ramp | None = None
    glossy: list[Floats] = field(default_factory=list)  # outlines on the floor where returns are lost
    dropout: float = 0.05  # share of the pixels that the sensor loses at random
    grazing: float = GRAZING  # sine of the angle below which its surfaces return nothing: the rougher, the less

    def lay(self, outline: Floats, height: float = 0.0) -> None:
        """Add a level face, seen from above."""
        if len(outline) > 2:
            self.faces.append(at(outline, height))

    def cut(self, hole: Floats, depth: float) -> None:
        """Add the ground with a hole in it. What is seen through the hole has to be added beside."""
        for piece in around(GROUND, hole):
            self.lay(piece)
        self.drops.append(Drop(hole, depth))

    def line(self, hole: Floats, bottom: float) -> None:
        """Add the walls of a hole, from the floor down to `bottom` [m], seen from within it."""
        self.faces += sides(hole[::-1], bottom, 0.0)

    def stand(self, outline: Floats, bottom: float, top: float) -> None:
        """Add an upright prism."""
        self.faces += prism(outline, bottom, top)
        self.obstacles.append(Obstacle(outline, bottom, top))

    def outlines(self) -> list[Outline]:
        """What is truly there, from above: drops, and what stands on the floor or over it."""
        drops = [Outline(drop.outline, "lower") for drop in self.drops]
        return drops + [
            Outline(each.outline, "overhead" if each.bottom >= BODY[1] else "obstacle") for each in self.obstacles
        ]

    def post(self, centre: Floats, radius: float, bottom: float, top: float) -> None:
        """Add an upright cylinder."""
        self.stand(centre + circle(radius), bottom, top)
