"""What is known of the floor around the robot: seen free, seen occupied, touched, or not known.

A camera 0.30 m high sees no floor nearer than 0.72 m, so an edge vanishes from view just before the robot reaches it.
What the scans showed is therefore kept, in the odometry's frame, until it is seen to be free or lies behind.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Cells = NDArray[np.int64]

CELL = 0.04  # [m]
HALF_CELL = CELL * math.sqrt(0.5)  # [m] from a cell's middle to its corners
MEMORY = 3.0  # [m] what lies farther off is forgotten
CELLS = 2 * round(MEMORY / CELL)
LOOK = 1.5  # [m] around the robot within which floor is seen to be free, and as far as it looks ahead
WIDEST = math.radians(80.0)  # a scan is taken in that far to either side

UNKNOWN, FREE, OCCUPIED = range(3)
TOUCHED = 4  # added to any of them: forgiving a touch must not forget what was seen there


def _disc(radius: float) -> tuple[Cells, Floats]:
    """Cells around the one in the middle: offsets (2, n), the nearest first, and their distances [m]."""
    span = np.arange(-math.ceil(radius / CELL), math.ceil(radius / CELL) + 1)
    offsets = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2)
    distances = np.hypot(*offsets.T) * CELL
    order = np.argsort(distances, kind="stable")
    return np.ascontiguousarray(offsets[order].T), distances[order]


OFFSETS, DISTANCES = _disc(LOOK + CELL)


class Pose(NamedTuple):
    """A place in the odometry's frame: x, y [m], heading theta [rad]."""

    x: float
    y: float
    theta: float

    def to_world(self, points: Floats) -> Floats:
        """Points (2, n) [m] of this pose's frame, in the odometry's."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = points
        return np.stack([cos * x - sin * y + self.x, sin * x + cos * y + self.y])

    def from_world(self, points: Floats) -> Floats:
        """Points (2, n) [m] of the odometry's frame, in this pose's."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = points[0] - self.x, points[1] - self.y
        return np.stack([cos * x + sin * y, cos * y - sin * x])

    def then(self, other: Pose) -> Pose:
        """The pose that is `other` seen from this one."""
        x, y = self.to_world(np.array([other.x, other.y]))
        return Pose(float(x), float(y), self.theta + other.theta)


class Ground:
    """A square of cells around the robot that wanders with it: cell (i, j) of the world is kept at (i, j) mod CELLS.

    `start_free` [m] around the place where it begins counts as free: somebody put the robot there.
    """

    def __init__(self, pose: Pose, start_free: float) -> None:
        self._state = np.full((CELLS, CELLS), UNKNOWN, np.int8)
        self._centre = _cell(np.array([pose.x, pose.y]))
        self._set(self._covered(pose, start_free), UNKNOWN, FREE)

    def begin_again(self, pose: Pose, start_free: float) -> None:
        """Nobody knows what happened since: what was free may not be, what was in the way may still be."""
        self._state[self._state == FREE] = UNKNOWN
        self._set(self._covered(pose, start_free), UNKNOWN, FREE)

    def follow(self, pose: Pose, radius: float) -> None:
        """The robot is at `pose` now: its disc of `radius` [m] stands on floor, and what is far is forgotten.

        Not a cell more is freed than the disc covers: else the robot would creep ahead on floor nobody has seen.
        """
        centre = _cell(np.array([pose.x, pose.y]))
        for axis in (0, 1):
            self._forget(axis, int(centre[axis]))
        self._set(self._covered(pose, radius), UNKNOWN, FREE)

    def see(self, ranges: Floats, angles: Floats, range_max: float, pose: Pose, blind: float) -> None:
        """Take in a scan made at `pose`: ranges (beams,) [m] as REP-117 has them, at evenly spaced angles [rad].

        A cell is free when every beam that crosses it goes on beyond it. Nearer than `blind` [m] the camera sees
        no floor: there an occupied cell stays what it is, and one not known becomes free only together with the
        floor behind it, for a hole that begins unseen is first reported at `blind`.
        """
        if len(angles) > 1:
            cells, distances, azimuths = self._ahead(pose, min(max(-angles[0], angles[-1]), WIDEST))
            beyond = np.where(np.isnan(ranges), 0.0, np.minimum(ranges, range_max))
            least = _least_between(beyond, *_crossing(distances, azimuths, angles))
            self._set(cells[:, least > np.maximum(distances, blind) + HALF_CELL], UNKNOWN, FREE)
            seen = distances >= blind + HALF_CELL  # all of the cell
            self._set(cells[:, seen & (least > distances + HALF_CELL)], OCCUPIED, FREE)
        near = np.isfinite(ranges) & (ranges <= 2.0 * MEMORY)
        hits = ranges[near] * np.stack([np.cos(angles[near]), np.sin(angles[near])])
        self.occupy(pose.to_world(hits))

    def occupy(self, points: Floats) -> None:
        """Something is in the way at these points (2, n) [m] of the odometry's frame, as far as they are remembered."""
        place = self._places(points)
        self._state[place] = self._state[place] & TOUCHED | OCCUPIED

    def touch(self, points: Floats) -> None:
        """The robot felt something at these points (2, n) [m]; no scan undoes that, only forgive() and distance."""
        self._state[self._places(points)] |= TOUCHED

    def forgive(self) -> None:
        """Forget what was touched, but not what was seen at the same place."""
        felt = self._state >= TOUCHED
        self._state[felt] = np.maximum(self._state[felt] - TOUCHED, FREE)

    def not_free(self, pose: Pose, reach: float, unknown_too: bool) -> Floats:
        """Middles (2, n) [m], in the robot's frame, of the cells within `reach` [m] that are not free."""
        cells = self._within(pose, reach)
        state = self._state[tuple(cells % CELLS)]
        return pose.from_world(_middle(cells[:, (state >= OCCUPIED) | (unknown_too & (state == UNKNOWN))]))

    def _places(self, points: Floats) -> tuple[Cells, ...]:
        """Where the cells of those points (2, n) [m] are kept that lie inside the square."""
        cells = _cell(points)
        near = (np.abs(cells - self._centre[:, None]) < CELLS // 2).all(axis=0)
        return tuple(cells[:, near] % CELLS)

    def _set(self, cells: Cells, old: int, new: int) -> None:
        place = tuple(cells % CELLS)
        state = self._state[place]
        state[state == old] = new
        self._state[place] = state

    def _within(self, pose: Pose, reach: float) -> Cells:
        """World numbers (2, n) of the cells that lie within `reach` [m] (up to LOOK), and perhaps a few beyond."""
        count = int(np.searchsorted(DISTANCES, reach + CELL, side="right"))
        return OFFSETS[:, :count] + _cell(np.array([pose.x, pose.y]))[:, None]

    def _covered(self, pose: Pose, radius: float) -> Cells:
        """World numbers (2, n) of the cells whose middles a disc of `radius` [m] covers."""
        cells = self._within(pose, radius)
        x, y = _middle(cells)
        return cells[:, (x - pose.x) ** 2 + (y - pose.y) ** 2 < radius**2]

    def _ahead(self, pose: Pose, side: float) -> tuple[Cells, Floats, Floats]:
        """The cells in front of a scanner that sees `side` [rad] to either side, their distances [m] and azimuths."""
        cells = self._within(pose, LOOK)
        x, y = pose.from_world(_middle(cells))
        front = np.flatnonzero(np.abs(y) < x * math.tan(side))
        x, y = x[front], y[front]
        return cells[:, front], np.hypot(x, y), np.arctan2(y, x)

    def _forget(self, axis: int, to: int) -> None:
        """Move the square along one axis; the lines that come in are not known."""
        moved = to - int(self._centre[axis])
        if moved:
            edge = to + (CELLS // 2 - 1 if moved > 0 else -CELLS // 2)
            lines = np.arange(edge, edge - moved, -int(math.copysign(1, moved)))[:CELLS] % CELLS
            self._state[(lines, slice(None)) if axis == 0 else (slice(None), lines)] = UNKNOWN
            self._centre[axis] = to


def _cell(points: Floats) -> Cells:
    return np.floor(points / CELL).astype(np.int64)


def _middle(cells: Cells) -> Floats:
    return (cells.astype(np.float64) + 0.5) * CELL


def _crossing(distances: Floats, azimuths: Floats, angles: Floats) -> tuple[Cells, Cells]:
    """First and last beam that touch each cell; beyond the scan's sides first is after last."""
    increment = angles[1] - angles[0]
    half = np.arcsin(np.minimum(HALF_CELL / distances, 1.0))
    first = np.floor((azimuths - half - angles[0]) / increment + 0.5).astype(np.int64)
    last = np.floor((azimuths + half - angles[0]) / increment + 0.5).astype(np.int64)
    inside = (first >= 0) & (last < len(angles))
    return np.where(inside, first, 0), np.where(inside, last, -1)


def _least_between(values: Floats, first: Cells, last: Cells) -> Floats:
    """The least of values[first ... last] for each pair; 0 where there is none. A table of all powers of two."""
    tables = [values]
    while 2 ** len(tables) <= len(values):
        half = 2 ** (len(tables) - 1)
        tables.append(np.minimum(tables[-1][:-half], tables[-1][half:]))
    size = last - first + 1
    level = np.log2(np.maximum(size, 1)).astype(np.int64)
    least = np.zeros(len(first))
    for step, table in enumerate(tables):
        chosen = (level == step) & (size > 0)
        least[chosen] = np.minimum(table[first[chosen]], table[last[chosen] - 2**step + 1])
    return least
