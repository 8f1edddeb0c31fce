"""Convex polygons on the floor plan: cutting them, and where a line enters and leaves one.

A polygon is (corners, 2) [m], counter-clockwise.
"""

import math

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats

SLIVER = 1e-9  # [m²] a piece of less area is rounding


def direction(angle: float) -> Floats:
    """The unit vector (2,) of that azimuth [rad]."""
    return np.array([math.cos(angle), math.sin(angle)])


def rectangle(centre: Floats, length: float, width: float, yaw: float) -> Floats:
    """`length` [m] along the direction of yaw [rad], `width` across it."""
    ahead, aside = direction(yaw) * length / 2, direction(yaw + math.pi / 2) * width / 2
    return np.stack([centre - ahead - aside, centre + ahead - aside, centre + ahead + aside, centre - ahead + aside])


def clip(polygon: Floats, normal: Floats, offset: float) -> Floats:
    """The part of a polygon where normal · p <= offset; (0, 2) where there is none."""
    kept: list[Floats] = []
    beyond = polygon @ normal - offset
    for i, corner in enumerate(polygon):
        before, here = beyond[i - 1], beyond[i]
        if (before > 0.0) != (here > 0.0):
            kept.append(polygon[i - 1] + before / (before - here) * (corner - polygon[i - 1]))
        if here <= 0.0:
            kept.append(corner)
    return np.array(kept).reshape(-1, 2)


def normals(polygon: Floats) -> tuple[Floats, Floats]:
    """The outward normals (sides, 2) of the sides, and their offsets (sides,): inside, normal · p <= offset."""
    sides = np.roll(polygon, -1, axis=0) - polygon
    outward = np.column_stack([sides[:, 1], -sides[:, 0]])
    return outward, np.einsum("ij,ij->i", outward, polygon)


def around(area: Floats, hole: Floats) -> list[Floats]:
    """What a hole leaves of an area, in convex pieces: of each side in turn, what lies beyond it."""
    pieces = []
    rest = area
    for normal, offset in zip(*normals(hole), strict=True):
        pieces.append(clip(rest, -normal, -float(offset)))
        rest = clip(rest, normal, float(offset))
    return [piece for piece in pieces if len(piece) > 2 and surface(piece) > SLIVER]


def surface(polygon: Floats) -> float:
    """Area [m²]."""
    x, y = polygon.T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def crossing(polygon: Floats, origin: Floats, steps: Floats) -> tuple[Floats, Floats]:
    """How many steps from the origin (2,) lines enter and leave a polygon: two of (n,); (inf, -inf) = they miss it.

    steps: (n, 2) [m]. With unit vectors the results are distances [m]. Behind the origin they are negative.
    """
    outward, offsets = normals(polygon)
    speed = steps @ outward.T
    room = offsets - outward @ origin
    with np.errstate(divide="ignore", invalid="ignore"):
        when = room / speed
    enter = np.where(speed < 0.0, when, -math.inf).max(axis=1)
    leave = np.where(speed > 0.0, when, math.inf).min(axis=1)
    missed = ((speed == 0.0) & (room < 0.0)).any(axis=1) | (enter >= leave)
    return np.where(missed, math.inf, enter), np.where(missed, -math.inf, leave)


def contains(polygon: Floats, points: Floats, margin: float = 0.0) -> NDArray[np.bool_]:
    """Whether points (n, 2) [m] lie inside, or within about `margin` [m] of it: (n,)."""
    outward, offsets = normals(polygon)
    beyond = (points @ outward.T - offsets) / np.linalg.norm(outward, axis=1)
    inside: NDArray[np.bool_] = (beyond <= margin).all(axis=1)
    return inside
