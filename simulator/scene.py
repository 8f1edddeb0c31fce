"""Scenes made of boxes, posts and ramps, written as MuJoCo XML."""

from __future__ import annotations

import math
from typing import NamedTuple

COLOURS = {
    "floor": "0.72 0.70 0.66 1",
    "wall": "0.55 0.62 0.70 1",
    "thing": "0.62 0.48 0.35 1",
    "post": "0.35 0.30 0.28 1",
}
RAMP_THICKNESS = 0.1  # [m]


class Rectangle(NamedTuple):
    """A part of the floor plan along its axes [m]."""

    left: float
    right: float
    near: float
    far: float

    @property
    def centre(self) -> tuple[float, float]:
        """Its middle (x, y)."""
        return (self.left + self.right) / 2, (self.near + self.far) / 2

    def grown(self, margin: float) -> Rectangle:
        """The rectangle that reaches farther on all sides, less far for a margin below 0."""
        return Rectangle(self.left - margin, self.right + margin, self.near - margin, self.far + margin)

    def meets(self, other: Rectangle) -> bool:
        """Whether they have an area in common."""
        across = self.left < other.right and other.left < self.right
        return across and self.near < other.far and other.near < self.far


class Scene:
    """Geoms that gather until they are written. Heights are those of a geom's lower and upper side [m]."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._geoms: list[str] = []

    def box(self, name: str, area: Rectangle, bottom: float, top: float, colour: str = "thing") -> None:
        """An upright box along the axes."""
        half = ((area.right - area.left) / 2, (area.far - area.near) / 2, (top - bottom) / 2)
        self._add(name, "box", (*area.centre, (bottom + top) / 2), half, colour)

    def post(self, name: str, x: float, y: float, radius: float, bottom: float, top: float) -> None:
        """An upright cylinder."""
        self._add(name, "cylinder", (x, y, (bottom + top) / 2), (radius, (top - bottom) / 2), "post")

    def turned_box(
        self, name: str, place: tuple[float, float], half: tuple[float, float], yaw: float, top: float
    ) -> None:
        """An upright box on the floor, turned by yaw [rad]; half: its half-sizes [m] before that."""
        x, y = place
        self._add(name, "box", (x, y, top / 2), (*half, top / 2), "thing", f'euler="0 0 {math.degrees(yaw):.9g}"')

    def ramp(self, name: str, area: Rectangle, climb: float) -> None:
        """A ramp that climbs along +x by `climb` [m], up from the floor; below 0, down to it."""
        run = area.right - area.left
        angle = math.atan2(climb, run)
        x, y = area.centre
        half = RAMP_THICKNESS / 2
        centre = (x + half * math.sin(angle), y, abs(climb) / 2 - half * math.cos(angle))
        size = (run / 2 / math.cos(angle), (area.far - area.near) / 2, half)
        self._add(name, "box", centre, size, "floor", f'euler="0 {-math.degrees(angle):.9g} 0"')

    def xml(self) -> str:
        """The scene as MuJoCo reads it."""
        geoms = "\n    ".join(self._geoms)
        return f'<mujoco model="{self.name}">\n  <worldbody>\n    {geoms}\n  </worldbody>\n</mujoco>\n'

    def _add(
        self, name: str, kind: str, place: tuple[float, ...], size: tuple[float, ...], colour: str, turn: str = ""
    ) -> None:
        numbers = (" ".join(f"{value:.9g}" for value in values) for values in (place, size))
        pos, half = numbers
        self._geoms.append(
            f'<geom name="{name}" type="{kind}" pos="{pos}" size="{half}" rgba="{COLOURS[colour]}" {turn}/>'
        )
