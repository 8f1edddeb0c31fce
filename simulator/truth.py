"""Where the floor ends and the obstacles stand, computed from the world's geometry: what a perfect scan would say.

Beams start at the robot's pose and run along the floor plan. Angles are those of the scan frame: counter-clockwise from
the robot's heading. Floor are all surfaces at z = 0, and what ramps lead to from there. Results are exact for upright
boxes and cylinders and for ramps; a world with anything else raises ValueError.
"""

import math
from typing import Literal, NamedTuple, get_args

import numpy as np

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.footprints import Footprint, footprints
from cliffscan.simulator.profile import FLUSH, walk
from cliffscan.simulator.world import World

Kind = Literal["lower", "floor", "obstacle", "overhead"]
LAYERS = get_args(Kind)

BODY = (0.01, 0.42)  # [m] heights at which something is in a TurtleBot's way


class Outline(NamedTuple):
    """A piece of the scene from above: its closed polygon (n, 2) [m], the first corner repeated last, and what it is.

    lower: its top is below the floor, as a stair's; floor: its top is floor, or a ramp's; obstacle: it stands in the
    robot's way; overhead: the robot passes under it. A hole is where no floor is.
    """

    polygon: Floats
    kind: Kind


def floor_edge(world: World, angles: Floats, heights: tuple[float, float] = BODY) -> Floats:
    """Distance [m] at which the floor under each beam first ends by a drop, however far: (n,), 0 = under the robot.

    inf where it does not: an obstacle between the heights [m] over the floor stands at the edge or before it. What lies
    on the floor and is lower or higher than that does not end a beam; floor continues under whatever stands on it.
    angles: (n,) [rad].
    """
    edge, obstacles = walk(footprints(world), world.pose, angles, *heights)
    return np.where(obstacles <= edge + FLUSH, math.inf, edge)


def obstacle(world: World, angles: Floats, low: float, high: float) -> Floats:
    """Distance [m] of the nearest part of any geom between the heights low and high [m] over the floor: (n,).

    inf where there is none, 0 where the robot stands inside one. Beyond a drop heights count from the floor before it.
    angles: (n,) [rad].
    """
    return walk(footprints(world), world.pose, angles, low, high)[1]


def outlines(world: World) -> list[Outline]:
    """The scene from above, in the order in which to draw it: from the lowest kind to the highest."""
    drawn = [Outline(closed(piece.outline()), kind(piece)) for piece in footprints(world)]
    return sorted(drawn, key=lambda outline: LAYERS.index(outline.kind))


def closed(ring: Floats) -> Floats:
    """A polygon (n, 2) with its first corner repeated: (n + 1, 2)."""
    return np.vstack([ring, ring[:1]])


def kind(piece: Footprint) -> Kind:
    """What a piece of the scene is to a robot on the floor."""
    if piece.walkable:
        return "floor"
    if piece.top < -FLUSH:
        return "lower"
    if piece.top <= FLUSH:
        return "floor"
    return "overhead" if piece.bottom >= BODY[1] else "obstacle"
