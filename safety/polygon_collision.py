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

TINY = 1e-7  # [m] by which a point that is near already may come nearer, so that it begins outside
LEAST = 1e-12  # [m] that stands for no distance where it divides


class Edges(NamedTuple):
    """The k edges of a polygon, each from one corner to the next."""

    starts: Floats  # (2, k) [m]
    along: Floats  # (2, k) unit vectors
    lengths: Floats  # (k,) [m]

    @classmethod
    def of(cls, corners: Floats) -> Self:
        """The edges between corners (2, k) [m], the last of which leads back to the first."""
        along = np.roll(corners, -1, axis=1) - corners
        lengths = np.hypot(*along)
        return cls(corners, along / lengths, lengths)

    @property
    def across(self) -> Floats:
        """(2, k) unit vectors, each at right angles to its edge."""
        return np.stack([-self.along[1], self.along[0]])


def covers(edges: Edges, x: Floats, y: Floats) -> Mask:
    """Which points, of one shape [m], lie inside: a ray along x meets the border an odd number of times."""
    inside = np.zeros(np.shape(x), np.bool_)
    for (ax, ay), (ux, uy), length in zip(edges.starts.T, edges.along.T, edges.lengths, strict=True):
        if uy != 0.0:
            spans = (ay > y) != (ay + length * uy > y)
            inside ^= spans & (x < ax + (y - ay) * (ux / uy))
    return inside


def distances(edges: Edges, points: Floats) -> Floats:
    """How far [m] points (2, n) are from the border, negative inside: (n,)."""
    apart: Floats = np.hypot(*(points - _nearest(edges, points)))
    apart[covers(edges, *points)] *= -1.0
    return apart


class Path(Protocol):
    """How the robot moves. What a way along it is measured in is the path's own: [m] or [rad]."""

    def meets(self, edges: Edges, points: Floats, kept: float) -> Mask:
        """Which points (2, n) the hull can come to within `kept` [m] of: (n,), all of them and more."""

    def way(self, edges: Edges, points: Floats, kept: Floats) -> Floats:
        """After which way the hull is within `kept` (n,) [m] of points (2, n) farther away: (n,), inf for never."""

    def approach(self, points: Floats) -> Floats:
        """Where points (2, n) move to, as the robot sees it: (2, n), of any length."""


def free_ways(path: Path, edges: Edges, points: Floats, kept: float, clearance: float) -> Floats:
    """The way along the path until the hull is `kept` [m] from each of points (2, n): (n,), inf for never.

    What the path passes at `clearance` [m] or more, `kept` at most, is not in the way. A point that is nearer already
    may not come nearer than it is, and one that the hull covers may only come out of it.
    """
    ways = np.full(points.shape[1], math.inf)
    near = np.flatnonzero(path.meets(edges, points, kept))
    apart = distances(edges, points[:, near])
    covered, outside = near[apart <= TINY], near[apart > TINY]
    ways[covered[_sinks_in(path, edges, points[:, covered])]] = 0.0
    apart = apart[apart > TINY] - TINY
    passed = path.way(edges, points[:, outside], np.minimum(apart, clearance))
    met = np.isfinite(passed)
    ways[outside[met]] = path.way(edges, points[:, outside[met]], np.minimum(apart[met], kept))
    return ways


class Straight:
    """Ahead, along x; ways are in metres."""

    def meets(self, edges: Edges, points: Floats, kept: float) -> Mask:
        """See Path."""
        low, high = edges.starts.min(axis=1) - kept, edges.starts.max(axis=1) + kept
        beside: Mask = (points[1] > low[1]) & (points[1] < high[1]) & (points[0] > low[0])
        return beside

    def way(self, edges: Edges, points: Floats, kept: Floats) -> Floats:
        """See Path."""
        x, y = points
        cx, cy = edges.starts[:, :, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            corners = cx + np.sqrt(kept**2 - (y - cy) ** 2)
            (ax, ay), (ux, uy) = edges.across[:, :, None], edges.along[:, :, None]
            ends = [corners]
            for side in (kept, -kept):
                way = (y - cy - side * ay) / uy
                inside = (way >= 0.0) & (way <= edges.lengths[:, None])
                ends.append(np.where(inside, cx + side * ax + way * ux, math.nan))
            ways = x - np.concatenate(ends)  # (3 k, n)
        least: Floats = np.where(ways >= 0.0, ways, math.inf).min(axis=0, initial=math.inf)
        return least

    def approach(self, points: Floats) -> Floats:
        """See Path."""
        return np.stack([np.full(points.shape[1], -1.0), np.zeros(points.shape[1])])


class Turn:
    """To the left, around a middle `radius` [m] to the left, 0 for a turn on the spot; ways are in radians."""

    def __init__(self, radius: float) -> None:
        self._middle = np.array([[0.0], [radius]])

    def meets(self, edges: Edges, points: Floats, kept: float) -> Mask:
        """See Path."""
        around = np.hypot(*(points - self._middle))
        widest = np.hypot(*(edges.starts - self._middle)).max() + kept
        met: Mask = (around < widest) & (around > distances(edges, self._middle)[0] - kept)
        return met

    def way(self, edges: Edges, points: Floats, kept: Floats) -> Floats:
        """See Path."""
        x, y = points - self._middle
        around, begins = np.maximum(np.hypot(x, y), LEAST), np.arctan2(y, x)
        starts = (edges.starts - self._middle)[:, :, None]
        with np.errstate(invalid="ignore"):
            ends = list(_met_corners(starts, around, kept))
            for side in (kept, -kept):
                ends += _met_lines(edges, starts, around, side)
            ways = (begins - np.concatenate(ends)) % math.tau  # (6 k, n)
        least: Floats = np.where(np.isnan(ways), math.inf, ways).min(axis=0, initial=math.inf)
        return least

    def approach(self, points: Floats) -> Floats:
        """See Path."""
        x, y = points - self._middle
        return np.stack([y, -x])


def _met_corners(starts: Floats, around: Floats, kept: Floats) -> tuple[Floats, Floats]:
    """Azimuths [rad] at which circles of radius `around` meet those of radius `kept` around corners (2, k, 1)."""
    away, azimuths = np.maximum(np.hypot(*starts), LEAST), np.arctan2(starts[1], starts[0])
    half = np.arccos((around**2 + away**2 - kept**2) / (2.0 * around * away))
    return azimuths - half, azimuths + half


def _met_lines(edges: Edges, starts: Floats, around: Floats, side: Floats) -> list[Floats]:
    """Azimuths [rad] at which circles of radius `around` meet the edges moved `side` [m] to the left."""
    across, along = edges.across[:, :, None], edges.along[:, :, None]
    azimuths = np.arctan2(across[1], across[0])
    half = np.arccos(((starts * across).sum(axis=0) + side) / around)
    met = []
    for azimuth in (azimuths - half, azimuths + half):
        way = around * (np.cos(azimuth) * along[0] + np.sin(azimuth) * along[1]) - (starts * along).sum(axis=0)
        met.append(np.where((way >= 0.0) & (way <= edges.lengths[:, None]), azimuth, math.nan))
    return met


def _sinks_in(path: Path, edges: Edges, points: Floats) -> Mask:
    """Which points (2, n), all covered, do not come out the shortest way."""
    outward = _nearest(edges, points) - points
    sinks: Mask = (path.approach(points) * outward).sum(axis=0) <= 0.0
    return sinks


def _nearest(edges: Edges, points: Floats) -> Floats:
    """The points (2, n) of the border that are nearest to points (2, n)."""
    starts, along = edges.starts[:, :, None], edges.along[:, :, None]
    away = points[:, None, :] - starts  # (2, k, n)
    feet = starts + np.clip((away * along).sum(axis=0), 0.0, edges.lengths[:, None]) * along
    nearest = ((points[:, None, :] - feet) ** 2).sum(axis=0).argmin(axis=0)
    return np.take_along_axis(feet, nearest[None, None, :], axis=1)[:, 0]
