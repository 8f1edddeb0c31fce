"""How far a hull that is a polygon can go along a line or an arc, or turn on the spot, before it touches a point.

Seen from the robot a point moves on a line, or on a circle around the middle of the arc. It touches the hull where it
comes too near to an edge: where its path meets a circle around a corner, or a line beside an edge. Both have a closed
form. The slow twin, a hull that is moved in small steps, is tests/naive_hull.py.
"""

import math
from typing import NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Indices = NDArray[np.intp]

TINY = 1e-7  # [m] by which a point that is near already may come nearer, so that it begins outside
LEAST = 1e-12  # [m] that stands for no distance where it divides


class Edges(NamedTuple):
    """The k edges of a polygon, each from one corner to the next, with the inside to the left."""

    starts: Floats  # (2, k) [m]
    along: Floats  # (2, k) unit vectors
    outward: Floats  # (2, k) unit vectors at right angles to them
    lengths: Floats  # (k,) [m]
    low: Floats  # (2,) [m] corners of the box around it
    high: Floats

    @classmethod
    def of(cls, corners: Floats) -> Self:
        """The edges between corners (2, k) [m] of either order, of which the last is beside the first."""
        (x, y), (next_x, next_y) = corners, np.roll(corners, -1, axis=1)
        if (x * next_y - next_x * y).sum() < 0.0:
            corners = corners[:, ::-1]
        along = np.roll(corners, -1, axis=1) - corners
        lengths = np.hypot(*along)
        along = along / lengths
        outward = np.stack([along[1], -along[0]])
        return cls(corners, along, outward, lengths, corners.min(axis=1), corners.max(axis=1))


def covers(edges: Edges, x: Floats, y: Floats) -> Mask:
    """Which points, (n,) [m] each, lie inside: a ray along x meets the border an odd number of times."""
    ax, ay = edges.starts[:, :, None]
    above = ay > y  # (k, n)
    spans = above != np.roll(above, -1, axis=0)
    ux, uy = edges.along
    slopes = np.divide(ux, uy, out=np.zeros_like(uy), where=uy != 0.0)[:, None]
    inside: Mask = np.logical_xor.reduce(spans & (x < ax + (y - ay) * slopes), axis=0)
    return inside


def distances(edges: Edges, points: Floats) -> Floats:
    """How far [m] points (2, n) are from the border, negative inside: (n,)."""
    gaps = _gaps(edges, points)
    apart: Floats = np.sqrt((gaps * gaps).sum(axis=0).min(axis=0))
    return np.where(covers(edges, *points), -apart, apart)


def distances_within(edges: Edges, points: Floats, most: float) -> Floats:
    """The same where points (2, n) are nearer than `most` [m], inf for those that are surely not: (n,)."""
    (left, back), (right, front), (x, y) = edges.low - most, edges.high + most, points
    near = np.flatnonzero((x > left) & (x < right) & (y > back) & (y < front))
    apart = np.full(len(x), math.inf)
    if near.size:
        apart[near] = distances(edges, points[:, near])
    return apart


class Path(Protocol):
    """How a hull moves. What a way along it is measured in is the path's own: [m] or [rad]."""

    edges: Edges  # of the hull

    def beside(self, points: Floats, kept: float) -> Indices:
        """Numbers of the points (2, n) that the hull can come to within `kept` [m] of: of all of them, and of more."""

    def meets(self, points: Floats, kept: Floats) -> Mask:
        """Whether the hull comes to within `kept` (n,) [m] of points (2, n) that are farther away: (n,)."""

    def way(self, points: Floats, kept: Floats) -> Floats:
        """After which way it does: (n,), inf for never."""

    def approach(self, points: Floats) -> Floats:
        """Where points (2, n) move to, as the robot sees it: (2, n), of any length."""


def free_ways(path: Path, points: Floats, kept: float, clearance: float) -> Floats:
    """The way along the path until the hull is `kept` [m] from each of points (2, n): (n,), inf for never.

    What the path passes at `clearance` [m] or more, `kept` at most, is not in the way. A point that is nearer already
    may not come nearer than it is, and one that the hull covers may only come out of it.
    """
    ways = np.full(points.shape[1], math.inf)
    which = path.beside(points, kept)
    if not which.size:
        return ways
    points = points[:, which]
    apart = distances_within(path.edges, points, kept + 2.0 * TINY)
    covered = apart <= TINY
    if covered.any():
        ways[which[covered][_sinks_in(path, points[:, covered])]] = 0.0
        which, points, apart = which[~covered], points[:, ~covered], apart[~covered]
    apart = apart - TINY
    met = np.flatnonzero(path.meets(points, np.minimum(apart, clearance)))
    if met.size:
        ways[which[met]] = path.way(points[:, met], np.minimum(apart[met], kept))
    return ways


class Straight:
    """Ahead, along x; ways are in metres."""

    def __init__(self, edges: Edges) -> None:
        self.edges = edges

    def beside(self, points: Floats, kept: float) -> Indices:
        """See Path."""
        x, y = points
        (left, right), back = (self.edges.low[1] - kept, self.edges.high[1] + kept), self.edges.low[0] - kept
        return np.flatnonzero((y > left) & (y < right) & (x > back))

    def meets(self, points: Floats, kept: Floats) -> Mask:
        """See Path."""
        met: Mask = self.way(points, kept) < math.inf
        return met

    def way(self, points: Floats, kept: Floats) -> Floats:
        """See Path."""
        x, y = points
        cx, cy = self.edges.starts[:, :, None]
        front = self.edges.outward[0] > 0.0  # the other edges are not met from behind
        ax, ay, nx, ny = *self.edges.starts[:, front, None], *self.edges.outward[:, front, None]
        across = y - ay - kept * ny  # [m] beyond where the line beside the edge begins
        with np.errstate(invalid="ignore"):
            corners = cx + np.sqrt(kept * kept - (y - cy) ** 2)
        lines = ax + kept * nx - across * ny / nx
        beside = (across >= 0.0) & (across <= self.edges.lengths[front, None] * nx)
        ways = x - np.concatenate([corners, np.where(beside, lines, math.nan)])
        least: Floats = np.where(ways >= 0.0, ways, math.inf).min(axis=0)
        return least

    def approach(self, points: Floats) -> Floats:
        """See Path."""
        return np.stack([np.full(points.shape[1], -1.0), np.zeros(points.shape[1])])


class Turn:
    """To the left, around a middle `radius` [m] to the left, 0 for a turn on the spot; ways are in radians.

    What moves clockwise around the middle comes to a circle around a corner at the last azimuth that they share, and
    to the line beside an edge at the first.
    """

    def __init__(self, edges: Edges, radius: float) -> None:
        self.edges = edges
        self._radius = radius
        x, y = self._starts = edges.starts - np.array([[0.0], [radius]])
        self._away = np.maximum(np.sqrt(x * x + y * y), LEAST)[:, None]  # [m] of the corners
        self._lines = (self._starts * edges.outward).sum(axis=0)[:, None]  # [m] from the middle, negative to the left
        self._ends = -(self._starts * edges.along).sum(axis=0)[:, None]  # [m] of each line's foot beyond its start

    def beside(self, points: Floats, kept: float) -> Indices:
        """See Path."""
        square = self._square(points)
        inner = max(-float(self._starts[1].max()) - kept, 0.0)
        outer = float(self._away.max()) + kept
        return np.flatnonzero((square < outer**2) & (square >= inner**2))

    def meets(self, points: Floats, kept: Floats) -> Mask:
        """See Path."""
        square = self._square(points)
        corner = np.abs(np.sqrt(square) - self._away) <= kept
        met: Mask = (corner | self._on_edge(square, self._lines + kept)).any(axis=0)
        return met

    def way(self, points: Floats, kept: Floats) -> Floats:
        """See Path."""
        square, lines = self._square(points), self._lines + kept
        around, away = np.maximum(np.sqrt(square), LEAST), self._away
        azimuths = np.arctan2(*np.concatenate([self._starts, self.edges.outward], axis=1)[::-1, :, None])
        cosines = np.concatenate([(square + away * away - kept * kept) / (2.0 * around * away), lines / around])
        count = len(lines)
        with np.errstate(invalid="ignore"):
            halves = np.arccos(cosines)
        halves[count:] = np.where(self._on_edge(square, lines), -halves[count:], math.nan)
        ways = (np.arctan2(points[1] - self._radius, points[0]) - azimuths - halves) % math.tau
        least: Floats = np.fmin.reduce(ways, axis=0, initial=math.inf)
        return least

    def approach(self, points: Floats) -> Floats:
        """See Path."""
        x, y = points
        return np.stack([y - self._radius, -x])

    def _square(self, points: Floats) -> Floats:
        """The square [m²] of how far points (2, n) are from the middle."""
        x, y = points[0], points[1] - self._radius
        square: Floats = x * x + y * y
        return square

    def _on_edge(self, square: Floats, lines: Floats) -> Mask:
        """Whether circles come to lines (k, n) [m] from the middle beside the edges, and not beyond their ends."""
        with np.errstate(invalid="ignore"):
            before = np.sqrt(square - lines * lines)  # [m] of the line's foot; NaN where a circle does not reach it
        on_edge: Mask = (before <= self._ends) & (before >= self._ends - self.edges.lengths[:, None])
        return on_edge


def _sinks_in(path: Path, points: Floats) -> Mask:
    """Which points (2, n), all covered, go farther in, by the shortest way out."""
    gaps = _gaps(path.edges, points)
    nearest = (gaps * gaps).sum(axis=0).argmin(axis=0)
    inward = gaps[:, nearest, np.arange(len(nearest))]
    sinks: Mask = (path.approach(points) * inward).sum(axis=0) > 0.0
    return sinks


def _gaps(edges: Edges, points: Floats) -> Floats:
    """From each edge to points (2, n), the shortest way: (2, k, n) [m]."""
    starts, along = edges.starts[:, :, None], edges.along[:, :, None]
    away = points[:, None, :] - starts
    gaps: Floats = away - np.clip((away * along).sum(axis=0), 0.0, edges.lengths[:, None]) * along
    return gaps
