"""Random floors with everything a robot can fall from, bump into or drive over; the same for the same seed.

The robot's start, at the origin, is free. Between any two things, and to the walls, there is room for it to pass.
"""

import math
from itertools import pairwise
from random import Random

from cliffscan.simulator.scene import Rectangle, Scene

START = Rectangle(-0.5, 0.9, -0.5, 0.5)  # [m] nothing is here
PASSAGE = 0.6  # [m] left free around each thing, for a TurtleBot 2
THICK = 0.1  # [m] of walls
FLOOR = -0.15  # [m] underside of the floor
ABYSS = -3.5  # [m] what is under everything
TRIES = 60  # to find a place before a thing is left out
RISER, TREAD = 0.17, 0.28  # [m] of stairs


def random_floor(seed: int, passage: float = PASSAGE) -> str:
    """The MuJoCo XML of the random floor of a seed, with that room [m] around each thing."""
    plan = FloorPlan(seed, passage)
    plan.divide()
    plan.hole("hole_0")  # first, for it finds a place nearly always
    for kind, least, most in (
        (plan.ramps, 0, 1),
        (plan.stairs, 0, 1),
        (plan.hole, 0, 2),
        (plan.kerb, 0, 2),
        (plan.table, 0, 2),
        (plan.box, 1, 7),
    ):
        for number in range(plan.random.randint(least, most)):
            kind(f"{kind.__name__}_{number + 1}")
    plan.build()
    return plan.scene.xml()


class FloorPlan:
    """A floor with walls around, on which things find their places one after the other."""

    def __init__(self, seed: int, passage: float) -> None:
        self.random = Random(seed)
        self._passage = passage
        self.scene = Scene(f"random_{seed}")
        between = self.random.uniform
        room = Rectangle(-between(1.2, 4.0), between(3.5, 7.0), -between(1.5, 4.0), between(1.5, 4.0))
        self.outer = Rectangle(*(passage / PASSAGE * side for side in room))
        self._taken = [START]
        self._cuts: list[Rectangle] = []

    def divide(self) -> None:
        """Put up to two walls with a door across the floor."""
        for number, (least, most) in enumerate(((1.6, self.outer.right - 1.5), (self.outer.left + 1.2, -1.1))):
            if least < most and self.random.random() < 0.5:
                self._partition(f"partition_{number}", self.random.uniform(least, most))

    def hole(self, name: str) -> None:
        """A hole whose ground lies far below."""
        between = self.random.uniform
        if area := self._place(between(0.4, 1.8), between(0.4, 1.8)):
            depth = between(0.3, 3.0)
            self.scene.box(f"{name}_ground", area.grown(0.3), -depth - 0.05, -max(depth, 0.05 - FLOOR), "floor")
            self._cuts.append(area)

    def kerb(self, name: str) -> None:
        """A part of the floor that lies a kerb lower, or higher."""
        between = self.random.uniform
        if area := self._place(between(0.8, 2.2), between(0.8, 2.2)):
            height = between(0.08, 0.15)
            if self.random.random() < 0.5:
                self.scene.box(name, area, 0.0, height, "floor")
            else:
                self.scene.box(f"{name}_lower", area, FLOOR - height, -height, "floor")
                self._cuts.append(area)

    def stairs(self, name: str) -> None:
        """A flight of stairs down, along one of the four directions."""
        count, width = self.random.randint(3, 7), self.random.uniform(0.8, 1.3)
        along_x, backward = self.random.random() < 0.5, self.random.random() < 0.5
        length = count * TREAD
        if area := self._place(*((length, width) if along_x else (width, length))):
            for step in range(count):
                tread = slice_of(area, step, count, along_x, backward)
                top = -(step + 1) * RISER
                self.scene.box(f"{name}_tread_{step}", tread, -(count + 1) * RISER, top, "floor")
            self._cuts.append(area)

    def ramps(self, name: str) -> None:
        """A platform between two ramps of at most 5 degrees."""
        between = self.random.uniform
        run, flat, climb = between(0.9, 1.4), between(0.5, 1.0), math.tan(math.radians(between(2.0, 5.0)))
        if area := self._place(2 * run + flat, between(0.8, 1.4)):
            left, right = area.left + run, area.right - run
            self.scene.ramp(f"{name}_up", area._replace(right=left), run * climb)
            self.scene.box(f"platform_{name}", area._replace(left=left, right=right), FLOOR, run * climb, "floor")
            self.scene.ramp(f"{name}_down", area._replace(left=right), -run * climb)

    def table(self, name: str) -> None:
        """A table on four thin legs, under which the robot can pass."""
        if area := self._place(self.random.uniform(0.9, 1.6), self.random.uniform(0.7, 1.0)):
            self.scene.box(name, area, 0.70, 0.73)
            corners = area.grown(-0.05)
            for leg, (x, y) in enumerate((x, y) for x in corners[:2] for y in corners[2:]):
                self.scene.post(f"{name}_leg_{leg}", x, y, self.random.uniform(0.015, 0.03), 0.0, 0.70)

    def box(self, name: str) -> None:
        """A box that stands at any angle."""
        between = self.random.uniform
        half, yaw = (between(0.05, 0.35), between(0.05, 0.35)), between(0.0, math.pi)
        reach = 2 * math.hypot(*half)
        if area := self._place(reach, reach):
            self.scene.turned_box(name, area.centre, half, yaw, between(0.06, 1.0))

    def build(self) -> None:
        """Lay the floor round all that was cut out of it, and put the walls up."""
        for number, part in enumerate(without(self.outer.grown(THICK), self._cuts)):
            self.scene.box(f"floor_{number}", part, FLOOR, 0.0, "floor")
        self.scene.box("abyss", self.outer.grown(2.0), ABYSS - 0.1, ABYSS, "floor")
        left, right, near, far = self.outer
        height = self.random.uniform(0.8, 2.5)
        walls = (
            Rectangle(left - THICK, left, near, far),
            Rectangle(right, right + THICK, near, far),
            Rectangle(left, right, near - THICK, near),
            Rectangle(left, right, far, far + THICK),
        )
        for number, wall in enumerate(walls):
            self.scene.box(f"wall_{number}", wall, 0.0, height, "wall")

    def _partition(self, name: str, x: float) -> None:
        door = self.random.uniform(0.9, 1.2) + self._passage - PASSAGE
        near = self.random.uniform(self.outer.near + 0.2, self.outer.far - 0.2 - door)
        wall = Rectangle(x - THICK / 2, x + THICK / 2, self.outer.near, self.outer.far)
        height = self.random.uniform(0.8, 2.5)
        self.scene.box(f"{name}_near", wall._replace(far=near), 0.0, height, "wall")
        self.scene.box(f"{name}_far", wall._replace(near=near + door), 0.0, height, "wall")
        self._taken.append(wall)

    def _place(self, width: float, depth: float) -> Rectangle | None:
        """A free part of the floor of a size [m], with a passage around it; None where none is found."""
        for _ in range(TRIES):
            room = self.outer.grown(-self._passage)
            if room.right - room.left < width or room.far - room.near < depth:
                return None
            left, near = (
                self.random.uniform(room.left, room.right - width),
                self.random.uniform(room.near, room.far - depth),
            )
            area = Rectangle(left, left + width, near, near + depth)
            if not any(area.grown(self._passage).meets(taken) for taken in self._taken):
                self._taken.append(area)
                return area
        return None


def slice_of(area: Rectangle, step: int, count: int, along_x: bool, backward: bool) -> Rectangle:
    """One of equal slices of an area, counted along x or y, forwards or backwards."""
    place = count - 1 - step if backward else step
    low, high = (area.left, area.right) if along_x else (area.near, area.far)
    begin, end = (low + (high - low) * part / count for part in (place, place + 1))
    return area._replace(left=begin, right=end) if along_x else area._replace(near=begin, far=end)


def without(area: Rectangle, cuts: list[Rectangle]) -> list[Rectangle]:
    """The parts of an area that are in none of the cuts. No two cuts meet."""
    parts = []
    edges = sorted({area.near, area.far, *(edge for cut in cuts for edge in (cut.near, cut.far))})
    for near, far in pairwise(edges):
        left = area.left
        for cut in sorted(cut for cut in cuts if cut.near < far and near < cut.far):
            parts.append(Rectangle(left, cut.left, near, far))
            left = cut.right
        parts.append(Rectangle(left, area.right, near, far))
    return parts
