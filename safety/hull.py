"""The shape of the robot from above: a disc or a polygon, around the middle between the wheels."""

import math
from typing import Protocol

import numpy as np

from cliffscan.safety import polygon_collision
from cliffscan.safety.arc_collision import NO_CONTACT, STRAIGHT, Contact, first_contact
from cliffscan.safety.polygon_collision import Edges, Floats, Mask, Path, Straight, Turn, free_ways

Corners = tuple[tuple[float, float], ...]  # x, y [m]


class Hull(Protocol):
    """What touches things. Points are in the robot's frame, x forward and y left.

    How near a point is, is told by the hull's own measure [m], in which the hull's rim is at `rim`.
    """

    outer: float  # [m] from the middle to its farthest point
    rim: float  # [m] what a point on the hull measures
    turns_free: bool  # whether a turn on the spot touches nothing new

    def measure(self, points: Floats) -> Floats:
        """How near points (2, n) [m] are: (n,) [m]."""

    def nearest(self, points: Floats, most: float) -> float:
        """How near the nearest of points (2, n) [m] is, `most` [m] at the most."""

    def covers(self, x: Floats, y: Floats) -> Mask:
        """Which points, (n,) [m] each, lie below the hull."""

    def on_rim(self, bearings: Floats) -> Floats:
        """The points (2, n) [m] of the hull in directions (n,) [rad] from its middle."""

    def on_arc(self, points: Floats, side: int, curvature: float, kept: float, clearance: float) -> Contact:
        """How far the robot can drive until it is `kept` from the first of points (2, n); see arc_collision."""

    def on_the_spot(self, points: Floats, direction: int, kept: float, clearance: float) -> Contact:
        """How far [rad] it can turn, to the left (1) or the right (-1), until it is `kept` from the first of them."""


class Disc:
    """A disc around the middle between the wheels."""

    turns_free = True

    def __init__(self, radius: float) -> None:
        self.outer = self.rim = radius

    def measure(self, points: Floats) -> Floats:
        """See Hull."""
        distances: Floats = np.sqrt(points[0] ** 2 + points[1] ** 2)
        return distances

    def nearest(self, points: Floats, most: float) -> float:
        """See Hull."""
        return float(self.measure(points).min(initial=most))

    def covers(self, x: Floats, y: Floats) -> Mask:
        """See Hull."""
        inside: Mask = x * x + y * y < self.rim * self.rim
        return inside

    def on_rim(self, bearings: Floats) -> Floats:
        """See Hull."""
        return self.rim * np.stack([np.cos(bearings), np.sin(bearings)])

    def on_arc(self, points: Floats, side: int, curvature: float, kept: float, clearance: float) -> Contact:
        """See Hull."""
        return first_contact(points, side, curvature, kept, clearance)

    def on_the_spot(self, points: Floats, direction: int, kept: float, clearance: float) -> Contact:  # noqa: ARG002
        """See Hull."""
        return NO_CONTACT


class Polygon:
    """A polygon, convex or not, that has the middle between the wheels inside."""

    turns_free = False
    rim = 0.0

    def __init__(self, corners: Corners) -> None:
        points = np.array(corners).T
        self._edges = Edges.of(points)
        self._mirrored = {(x, y): Edges.of(np.array([[x], [y]]) * points) for x in (1, -1) for y in (1, -1)}
        self.outer = float(np.hypot(*points).max())

    def measure(self, points: Floats) -> Floats:
        """See Hull."""
        return polygon_collision.distances(self._edges, points)

    def nearest(self, points: Floats, most: float) -> float:
        """See Hull."""
        return float(polygon_collision.distances_within(self._edges, points, most).min(initial=most))

    def covers(self, x: Floats, y: Floats) -> Mask:
        """See Hull."""
        return polygon_collision.covers(self._edges, x, y)

    def on_rim(self, bearings: Floats) -> Floats:
        """See Hull."""
        ahead = np.stack([np.cos(bearings), np.sin(bearings)])[:, None, :]  # (2, 1, n)
        starts, along = self._edges.starts[:, :, None], self._edges.along[:, :, None]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            crossing = ahead[0] * along[1] - ahead[1] * along[0]
            reach = (starts[0] * along[1] - starts[1] * along[0]) / crossing  # along the ray, to the edge's line
            way = (starts[0] * ahead[1] - starts[1] * ahead[0]) / crossing  # along the edge
            met = (reach > 0.0) & (way >= 0.0) & (way <= self._edges.lengths[:, None])
            farthest: Floats = np.where(met, reach, 0.0).max(axis=0)
        points: Floats = farthest * ahead[:, 0]
        return points

    def on_arc(self, points: Floats, side: int, curvature: float, kept: float, clearance: float) -> Contact:
        """See Hull."""
        handed = 1 if curvature >= 0.0 else -1
        edges = self._mirrored[side, handed]
        if abs(curvature) < STRAIGHT:
            return self._first(Straight(edges), points, side, handed, kept, clearance)
        radius = 1.0 / abs(curvature)
        angle, point = self._first(Turn(edges, radius), points, side, handed, kept, clearance)
        return Contact(radius * angle, point)

    def on_the_spot(self, points: Floats, direction: int, kept: float, clearance: float) -> Contact:
        """See Hull."""
        return self._first(Turn(self._mirrored[1, direction], 0.0), points, 1, direction, kept, clearance)

    def _first(self, path: Path, points: Floats, side: int, handed: int, kept: float, clearance: float) -> Contact:
        """The first point that is met on a path that is mirrored where it leads backward, or to the right."""
        ways = free_ways(path, np.array([[side], [handed]]) * points, kept, clearance)
        first = int(ways.argmin()) if ways.size else -1
        return Contact(float(ways[first]), first) if first >= 0 and ways[first] < math.inf else NO_CONTACT


def hull_of(radius: float, footprint: Corners) -> Hull:
    """The polygon of the footprint, or where there is none the disc of the radius [m]."""
    return Polygon(footprint) if footprint else Disc(radius)


def footprint_error(corners: Corners) -> str:
    """What makes a polygon no footprint, or nothing."""
    if len(corners) < 3:
        return f"{len(corners)} corners, expected none or three at least"
    points = np.array(corners).T
    edges = Edges.of(points) if (points != np.roll(points, -1, axis=1)).any(axis=0).all() else None
    if edges is None:
        return "two corners in a row are the same"
    if not polygon_collision.covers(edges, np.zeros(1), np.zeros(1))[0]:
        return "the middle between the wheels, (0, 0), lies outside"
    if _crosses_itself(points):
        return "two edges cross: give the corners in the order in which they follow one another"
    return ""


def _crosses_itself(corners: Floats) -> bool:
    """Whether two edges that are no neighbours meet."""
    count = corners.shape[1]
    ends = np.roll(corners, -1, axis=1)

    def left(a: Floats, b: Floats, c: Floats) -> float:
        return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    for i in range(count):
        for j in range(i + 2, count - (i == 0)):
            a, b, c, d = corners[:, i], ends[:, i], corners[:, j], ends[:, j]
            if left(a, b, c) * left(a, b, d) <= 0.0 and left(c, d, a) * left(c, d, b) <= 0.0:
                return True
    return False
