"""The scene as flat convex faces, the form in which it is drawn."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.world import World

ROUNDNESS = 0.5e-3  # [m] how far a prism that stands for a cylinder may be from it
COARSEST = 0.0048  # of the radius: however thin, a cylinder has 33 sides
# A box's corners are numbered 4 x + 2 y + z, each 0 or 1.
BOX_SIDES = ((0, 2, 6, 4), (1, 5, 7, 3), (0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5))


class Faces(NamedTuple):
    """Convex polygons: face i has the corners starts[i] to starts[i + 1], counter-clockwise seen from outside.

    corners: (n, 3) [m] in the world; starts: (faces + 1,).
    """

    corners: Floats
    starts: NDArray[np.int64]


def faces_of(world: World) -> Faces:
    """All faces of the scene's geoms. Raises ValueError for a geom that is neither a box nor a cylinder."""
    faces: list[Floats] = []
    for geom in world.scene_geoms():
        shape = SHAPES.get(mujoco.mjtGeom(world.model.geom_type[geom]))
        if shape is None:
            kind = mujoco.mjtGeom(world.model.geom_type[geom]).name
            raise ValueError(f"geom {geom} of world {world.name!r} is a {kind}; only boxes and cylinders can be drawn")
        rotation = world.data.geom_xmat[geom].reshape(3, 3)
        faces += [face @ rotation.T + world.data.geom_xpos[geom] for face in shape(world.model.geom_size[geom])]
    return pack(faces)


def pack(faces: Iterable[Floats]) -> Faces:
    """Faces one after the other; each is (corners, 3) [m]."""
    polygons = list(faces)
    starts = np.cumsum([0, *(len(polygon) for polygon in polygons)], dtype=np.int64)
    return Faces(np.concatenate([np.empty((0, 3)), *polygons]), starts)


def box_faces(half: Floats) -> list[Floats]:
    """The six sides of a box around its own origin; half: its half-sizes (3,) [m]."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    corners = signs * half
    return [corners[list(side)] for side in BOX_SIDES]


def cylinder_faces(size: Floats) -> list[Floats]:
    """The sides and caps of the prism that stands for an upright cylinder; size: radius and half-height [m]."""
    radius, half = float(size[0]), float(size[1])
    return prism(circle(radius), -half, half)


def prism(outline: Floats, bottom: float, top: float) -> list[Floats]:
    """The sides and caps of an upright prism over an outline (n, 2) [m], between two heights [m]."""
    return [*sides(outline, bottom, top), at(outline, top), at(outline[::-1], bottom)]


def at(outline: Floats, height: float) -> Floats:
    """An outline (n, 2) at a height [m]: (n, 3)."""
    return np.column_stack([outline, np.full(len(outline), height)])


def sides(outline: Floats, bottom: float, top: float) -> list[Floats]:
    """The upright faces along an outline, seen from its outside if it runs counter-clockwise."""
    low, high = at(outline, bottom), at(outline, top)
    following = np.roll(np.arange(len(outline)), -1)
    return [np.stack([low[i], low[j], high[j], high[i]]) for i, j in enumerate(following)]


def circle(radius: float) -> Floats:
    """The regular polygon (n, 2) [m] of the circle's own area, counter-clockwise and within ROUNDNESS of the circle."""
    sagitta = min(1.5 * ROUNDNESS / radius, COARSEST)  # the corners stick out of the circle by two thirds of it
    count = math.ceil(math.pi / math.acos(1.0 - sagitta))
    step = 2.0 * math.pi / count
    corner = radius * math.sqrt(step / math.sin(step))
    angles = step * np.arange(count)
    return corner * np.column_stack([np.cos(angles), np.sin(angles)])


SHAPES: dict[mujoco.mjtGeom, Callable[[Floats], list[Floats]]] = {
    mujoco.mjtGeom.mjGEOM_BOX: box_faces,
    mujoco.mjtGeom.mjGEOM_CYLINDER: cylinder_faces,
}
