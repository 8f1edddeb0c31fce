"""Where the floor ends and the obstacles stand, computed from the world's geometry: what a perfect scan would say.

Beams start at the robot's pose and run along the floor plan. Angles are those of the scan frame: counter-clockwise from
the robot's heading. Results are exact for upright boxes and cylinders; a world with anything else raises ValueError.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from simulator.footprints import Footprint, footprints
from simulator.world import World

Floats = NDArray[np.float64]
Kind = Literal["lower", "floor", "obstacle", "overhead"]
LAYERS = get_args(Kind)

FLUSH = 1e-3  # [m] steps and gaps up to this are floor
BODY = (0.01, 0.42)  # [m] heights at which something is in a TurtleBot's way


class Outline(NamedTuple):
    """A piece of the scene from above: its closed polygon (n, 2) [m], the first corner repeated last, and what it is.

    lower: its top is below the floor, as a stair's; floor: its top is the floor; obstacle: it stands in the robot's
    way; overhead: the robot passes under it. A hole is where no floor is.
    """

    polygon: Floats
    kind: Kind


def floor_edge(world: World, angles: Floats, heights: tuple[float, float] = BODY) -> Floats:
    """Distance [m] at which the floor under each beam first ends by a drop, however far: (n,), 0 = under the robot.

    inf where it does not: an obstacle between the heights [m] stands at the edge or before it. What lies on the floor
    and is lower or higher than that does not end a beam; floor continues under whatever stands on it.
    angles: (n,) [rad].
    """
    pieces = [piece for piece in footprints(world) if abs(piece.top) <= FLUSH]
    enter, leave = crossings(pieces, world, angles)
    order = np.argsort(enter, axis=0)
    enter, leave = np.take_along_axis(enter, order, axis=0), np.take_along_axis(leave, order, axis=0)
    covered = np.maximum.accumulate(np.vstack([np.zeros(len(angles)), leave]), axis=0)
    following = np.vstack([enter, np.full(len(angles), math.inf)])
    first_gap = np.argmax(following > covered + FLUSH, axis=0)
    edge = np.take_along_axis(covered, first_gap[None], axis=0)[0]
    return np.where(obstacle(world, angles, *heights) <= edge + FLUSH, math.inf, edge)


def obstacle(world: World, angles: Floats, low: float, high: float) -> Floats:
    """Distance [m] of the nearest part of any geom between the heights low and high [m]: (n,), inf where there is none.

    0 where the robot stands inside one. angles: (n,) [rad].
    """
    pieces = [piece for piece in footprints(world) if piece.top > low and piece.bottom < high]
    enter, leave = crossings(pieces, world, angles)
    ahead = np.where(leave >= 0.0, np.maximum(enter, 0.0), math.inf)
    nearest: Floats = ahead.min(axis=0, initial=math.inf)
    return nearest


def crossings(pieces: list[Footprint], world: World, angles: Floats) -> tuple[Floats, Floats]:
    """Distances [m] at which beams enter and leave pieces: two of (pieces, beams); (inf, -inf) = the beam misses."""
    origin = np.array([world.pose.x, world.pose.y])
    found = [piece.crossing(origin, angles + world.pose.yaw) for piece in pieces]
    table = np.array(found, dtype=np.float64).reshape(len(pieces), 2, len(angles))
    return table[:, 0], table[:, 1]


def outlines(world: World) -> list[Outline]:
    """The scene from above, in the order in which to draw it: from the lowest kind to the highest."""
    drawn = [Outline(closed(piece.outline()), kind(piece)) for piece in footprints(world)]
    return sorted(drawn, key=lambda outline: LAYERS.index(outline.kind))


def closed(ring: Floats) -> Floats:
    """A polygon (n, 2) with its first corner repeated: (n + 1, 2)."""
    return np.vstack([ring, ring[:1]])


def kind(piece: Footprint) -> Kind:
    """What a piece of the scene is to a robot on the floor."""
    if piece.top < -FLUSH:
        return "lower"
    if piece.top <= FLUSH:
        return "floor"
    return "overhead" if piece.bottom >= BODY[1] else "obstacle"
