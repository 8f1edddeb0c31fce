"""The scene seen from above: where boxes and cylinders stand, how high they are, and where a line crosses them."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.faces import circle
from cliffscan.simulator.world import World

UPRIGHT = math.cos(math.radians(0.1))  # a geom tilted more is a ramp
STEEPEST = math.cos(math.radians(6.0))  # of a ramp; a geom tilted more has no footprint
LEVEL = 1e-6  # how far a ramp's own y may climb, for each metre
PLATFORM = "platform"  # how the names of raised floors begin


@dataclass(frozen=True, eq=False)
class Footprint:
    """A box or cylinder: the area it covers on the floor plan, and the heights between which it does so [m].

    centre: (2,); size: (2,) half-sizes of a box before it is turned by yaw [rad], or (1,) radius of a cylinder.
    A ramp's area is that of its upper side, which has the height `top` at the centre and climbs by `slope` for each
    metre along its own x; its upper end must stand against something. walkable: a ramp, or a floor raised over others.
    """

    centre: Floats
    size: Floats
    yaw: float
    bottom: float
    top: float
    slope: float = 0.0
    walkable: bool = False

    def top_along(self, origin: Floats, angles: Floats) -> tuple[Floats, Floats]:
        """Height [m] of the upper side above a line's origin (2,) [m], were it as wide, and its climb for each metre.

        angles: (n,) [rad] in the world. Returns two of (n,).
        """
        return np.full(len(angles), self.top_at(origin)), self.slope * np.cos(angles - self.yaw)

    def top_at(self, points: Floats) -> Floats:
        """Height [m] of the upper side at points (..., 2) [m] of the floor plan, were it as wide: (...)."""
        height: Floats = self.top + self.slope * self._turned(points - self.centre)[0]
        return height

    def distance(self, points: Floats) -> Floats:
        """How far points (..., 2) [m] of the floor plan are from the area: (...) [m]; 0 within it."""
        x, y = self._turned(points - self.centre)
        beyond = [np.hypot(x, y)] if len(self.size) == 1 else [np.abs(x), np.abs(y)]
        distance: Floats = np.hypot.reduce(
            [np.maximum(far - size, 0.0) for far, size in zip(beyond, self.size, strict=True)]
        )
        return distance

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

    def _turned(self, offsets: Floats) -> tuple[Floats, Floats]:
        """Offsets (..., 2) [m] from the centre along the box's own axes: two of (...)."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        x, y = offsets[..., 0], offsets[..., 1]
        return cos * x + sin * y, cos * y - sin * x


def footprints(world: World) -> list[Footprint]:
    """Of all the scene's geoms. Raises ValueError for one that is neither an upright box or cylinder, nor a ramp."""
    return [footprint(world, geom) for geom in world.scene_geoms()]


def footprint(world: World, geom: int) -> Footprint:
    """Of the geom of that index. Raises ValueError where it has none."""
    kind = mujoco.mjtGeom(world.model.geom_type[geom])
    rotation = world.data.geom_xmat[geom].reshape(3, 3)
    size, centre = world.model.geom_size[geom], world.data.geom_xpos[geom]
    yaw = math.atan2(rotation[1, 0], rotation[0, 0])
    if rotation[2, 2] >= UPRIGHT and kind in (mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_CYLINDER):
        sides, half = (1, size[1]) if kind == mujoco.mjtGeom.mjGEOM_CYLINDER else (2, size[2])
        raised = world.model.geom(geom).name.startswith(PLATFORM)
        heights = float(centre[2] - half), float(centre[2] + half)
        return Footprint(centre[:2].copy(), size[:sides].copy(), yaw, *heights, walkable=raised)
    if kind == mujoco.mjtGeom.mjGEOM_BOX and rotation[2, 2] >= STEEPEST and abs(rotation[2, 1]) < LEVEL:
        return ramp(centre, rotation, size, yaw)
    raise ValueError(
        f"geom {geom} of world {world.name!r} has no footprint; only upright boxes and cylinders and boxes that climb "
        "gently along their own x have"
    )


def ramp(centre: Floats, rotation: Floats, size: Floats, yaw: float) -> Footprint:
    """Of a box that climbs along its own x."""
    upper = centre + rotation[:, 2] * size[2]  # the middle of its upper side
    run = math.hypot(rotation[0, 0], rotation[1, 0])
    slope = float(rotation[2, 0]) / run
    bottom = float(centre[2] - abs(rotation[2]) @ size)
    return Footprint(upper[:2], np.array([run * size[0], size[1]]), yaw, bottom, float(upper[2]), slope, walkable=True)


def slab_crossing(start: Floats, step: Floats, half: float) -> tuple[Floats, Floats]:
    """Distances between which |start + step · distance| <= half; (inf, -inf) where never."""
    moving = np.abs(step) > 1e-12
    pace = np.where(moving, step, 1.0)
    near, far = (-half - start) / pace, (half - start) / pace
    within = math.inf if abs(start) <= half else -math.inf
    enter = np.where(moving, np.minimum(near, far), -within)
    return enter, np.where(moving, np.maximum(near, far), within)


def disc_crossing(x: Floats, y: Floats, dx: Floats, dy: Floats, radius: float) -> tuple[Floats, Floats]:
    """Distances at which lines from (x, y) along the unit directions enter and leave a circle about (0, 0) [m]."""
    along = -(x * dx + y * dy)
    square = radius**2 - (x * dy - y * dx) ** 2
    half = np.sqrt(np.maximum(square, 0.0))
    return missed(np.where(square >= 0.0, along - half, math.inf), along + half)


def missed(enter: Floats, leave: Floats) -> tuple[Floats, Floats]:
    """The same crossings, (inf, -inf) where a line would leave before it enters."""
    crosses = enter <= leave
    return np.where(crosses, enter, math.inf), np.where(crosses, leave, -math.inf)
