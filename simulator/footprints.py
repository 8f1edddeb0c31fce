"""The scene seen from above: where upright boxes and cylinders stand, and where a line crosses them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from simulator.faces import circle
from simulator.world import World

Floats = NDArray[np.float64]

UPRIGHT = math.cos(math.radians(0.1))  # a geom tilted more has no footprint


@dataclass(frozen=True, eq=False)
class Footprint:
    """An upright box or cylinder: the area it covers on the floor plan, and the heights between which it does so [m].

    centre: (2,); size: (2,) half-sizes of a box before it is turned by yaw [rad], or (1,) radius of a cylinder.
    """

    centre: Floats
    size: Floats
    yaw: float
    bottom: float
    top: float

    def crossing(self, origin: Floats, angles: Floats) -> tuple[Floats, Floats]:
        """Distances [m] at which lines from the origin (2,) [m] enter and leave the area; (inf, -inf) = they miss it.

        angles: (n,) [rad] in the world. A distance is negative behind the origin.
        """
        x, y = self._turned(origin - self.centre)
        dx, dy = np.cos(angles - self.yaw), np.sin(angles - self.yaw)
        if len(self.size) == 1:
            return disc_crossing(x, y, dx, dy, float(self.size[0]))
        enter_x, leave_x = slab_crossing(x, dx, float(self.size[0]))
        enter_y, leave_y = slab_crossing(y, dy, float(self.size[1]))
        return missed(np.maximum(enter_x, enter_y), np.minimum(leave_x, leave_y))

    def outline(self) -> Floats:
        """The area's corners (n, 2) [m], counter-clockwise; the first is not repeated. A circle becomes a polygon."""
        if len(self.size) == 1:
            return self.centre + circle(float(self.size[0]))
        corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * self.size
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        turned: Floats = corners @ np.array([[cos, sin], [-sin, cos]])
        return self.centre + turned

    def _turned(self, offset: Floats) -> tuple[float, float]:
        """An offset (2,) [m] from the centre along the box's own axes."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return cos * offset[0] + sin * offset[1], cos * offset[1] - sin * offset[0]


def footprints(world: World) -> list[Footprint]:
    """Of all the scene's geoms. Raises ValueError for one that is not an upright box or cylinder."""
    return [footprint(world, geom) for geom in world.scene_geoms()]


def footprint(world: World, geom: int) -> Footprint:
    """Of the geom of that index. Raises ValueError where it is not an upright box or cylinder."""
    kind = mujoco.mjtGeom(world.model.geom_type[geom])
    rotation = world.data.geom_xmat[geom].reshape(3, 3)
    if kind not in (mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER) or rotation[2, 2] < UPRIGHT:
        raise ValueError(f"geom {geom} of world {world.name!r} has no footprint; only upright boxes and cylinders have")
    size = world.model.geom_size[geom]
    sides, half = (1, size[1]) if kind == mujoco.mjtGeom.mjGEOM_CYLINDER else (2, size[2])
    centre = world.data.geom_xpos[geom]
    yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    return Footprint(centre[:2].copy(), size[:sides].copy(), yaw, float(centre[2] - half), float(centre[2] + half))


def slab_crossing(start: float, step: Floats, half: float) -> tuple[Floats, Floats]:
    """Distances between which |start + step · distance| <= half; (inf, -inf) where never."""
    moving = np.abs(step) > 1e-12
    pace = np.where(moving, step, 1.0)
    near, far = (-half - start) / pace, (half - start) / pace
    within = math.inf if abs(start) <= half else -math.inf
    enter = np.where(moving, np.minimum(near, far), -within)
    return enter, np.where(moving, np.maximum(near, far), within)


def disc_crossing(x: float, y: float, dx: Floats, dy: Floats, radius: float) -> tuple[Floats, Floats]:
    """Distances at which lines from (x, y) along the unit directions enter and leave a circle about (0, 0) [m]."""
    along = -(x * dx + y * dy)
    square = radius**2 - (x * dy - y * dx) ** 2
    half = np.sqrt(np.maximum(square, 0.0))
    return missed(np.where(square >= 0.0, along - half, math.inf), along + half)


def missed(enter: Floats, leave: Floats) -> tuple[Floats, Floats]:
    """The same crossings, (inf, -inf) where a line would leave before it enters."""
    crosses = enter <= leave
    return np.where(crosses, enter, math.inf), np.where(crosses, leave, -math.inf)
