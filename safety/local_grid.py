"""What is known of the floor around the robot: free, occupied, an edge, touched, or not known.

A camera 0.30 m high sees no floor nearer than 0.72 m, so an edge vanishes from view just before the robot reaches it.
What the scans showed is therefore kept, in the odometry's frame, until it is seen to be free or lies behind.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.safety.beam_clearance import sector, seen_past

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

CELL = 0.04  # [m]
HALF_CELL = CELL * math.sqrt(0.5)  # [m] from a cell's middle to its corners
MEMORY = 3.0  # [m] what lies farther off is forgotten
CELLS = 2 * round(MEMORY / CELL)
LOOK = 1.5  # [m] around the robot within which floor is seen to be free, and as far as it looks ahead
BESIDE = 0.2  # [m] along which an edge that is seen may go on where it is not
WIDEST = math.radians(80.0)  # a scan is taken in that far to either side

FREE, GUESSED, UNKNOWN, OCCUPIED, EDGE = range(5)  # GUESSED is free because floor was seen behind it
KINDS = {UNKNOWN: "unseen floor", OCCUPIED: "obstacle", EDGE: "edge"}
TOUCHED = 8  # added to any of them: forgiving a touch must not forget what was seen there


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
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x, y = cos * other.x - sin * other.y, sin * other.x + cos * other.y
        return Pose(self.x + x, self.y + y, self.theta + other.theta)


class Ground:
    """A square of cells with the robot in the middle one; what leaves the square is forgotten.

    `start_free` [m] around the place where it begins counts as free: somebody put the robot there.
    """

    def __init__(self, pose: Pose, start_free: float) -> None:
        self._state = np.full((CELLS, CELLS), UNKNOWN, np.int8)
        self._corner = (0, 0)  # the number, among all cells of the world, of the square's first
        self.follow(pose, start_free)

    def begin_again(self, pose: Pose, start_free: float) -> None:
        """Nobody knows what happened since: what was free may not be, what was in the way may still be."""
        self._state[self._state <= GUESSED] = UNKNOWN
        self.follow(pose, start_free)

    def forget(self) -> None:
        """The robot was carried: nothing that was seen or felt says anything of where it stands now."""
        self._state[:] = UNKNOWN

    def follow(self, pose: Pose, radius: float) -> None:
        """The robot is at `pose` now: its disc of `radius` [m] stands on floor, and what is far is forgotten.

        Not a cell more is freed than the disc covers: else the robot would creep ahead on floor nobody has seen.
        """
        self._move(math.floor(pose.x / CELL) - CELLS // 2, math.floor(pose.y / CELL) - CELLS // 2)
        near = self._window(pose.x, pose.y, radius)
        dx, dy = self._offsets(near, pose)
        covered = (dx * dx)[:, None] + dy * dy < radius * radius
        cells = self._state[near]
        cells[covered & (cells <= UNKNOWN)] = FREE

    def see(self, ranges: Floats, edges: Mask, free: Floats, angles: Floats, pose: Pose, blind: float) -> None:
        """Take in a scan made at `pose`: (beams,) each, at evenly spaced angles [rad].

        ranges [m]: numbers are where something is in the way or, where `edges` says so, the floor ends; free [m]: how
        far a beam shows floor. A cell is free when every beam that crosses it shows floor beyond it. Nearer than
        `blind` [m] the camera sees no floor: there a cell in the way stays what it is, and one not known is guessed to
        be free together with the floor behind it, for a hole that begins unseen is first reported at `blind`; but not
        BESIDE an edge, which may go on there.
        """
        self.mark(ranges, edges, angles, pose)
        if len(angles) > 1:
            self._free(free, angles, pose, blind)

    def mark(self, ranges: Floats, edges: Mask, angles: Floats, pose: Pose) -> None:
        """Take in of such a scan what is in the way."""
        near = np.isfinite(ranges) & (ranges <= 2.0 * MEMORY)
        for which, state in ((near & ~edges, OCCUPIED), (near & edges, EDGE)):
            if which.any():
                hits, ways = ranges[which], angles[which]
                self.occupy(pose.to_world(np.stack([hits * np.cos(ways), hits * np.sin(ways)])), state)

    def occupy(self, points: Floats, state: int = OCCUPIED) -> None:
        """Something is in the way at these points (2, n) [m] of the odometry's frame, as far as they are remembered."""
        place = self._places(points)
        self._state[place] = self._state[place] & TOUCHED | state

    def touch(self, points: Floats) -> None:
        """The robot felt something at these points (2, n) [m]; no scan undoes that, only forgive() and distance."""
        self._state[self._places(points)] |= TOUCHED

    def forgive(self) -> None:
        """Forget what was touched, but not what was seen at the same place."""
        felt = self._state >= TOUCHED
        self._state[felt] -= TOUCHED

    def not_free(self, pose: Pose, reach: float, unknown_too: bool) -> Floats:
        """Middles (2, n) [m], in the robot's frame, of the cells that are not free: all within `reach` [m], and more.

        To be asked where the robot is, for LOOK at most: the square ends MEMORY away from there.
        """
        window = self._window(pose.x, pose.y, reach)
        cells = self._state[window]
        there = np.flatnonzero(cells >= (UNKNOWN if unknown_too else OCCUPIED))
        x, y = self._seen_from(pose, window)
        return np.stack([x.ravel()[there], y.ravel()[there]])

    def kind_at(self, point: Floats) -> str:
        """What is known of a cell that is not free: (2, 1) [m] in the odometry's frame."""
        state = int(self._state[self._places(point)][0])
        return "what was touched" if state >= TOUCHED else KINDS[state]

    def _free(self, free: Floats, angles: Floats, pose: Pose, blind: float) -> None:
        """Free what beams cross that show floor up to `free` [m]; what was seen free already need not be looked at."""
        side = min(max(-angles[0], angles[-1]), WIDEST)
        ahead, around = sector(LOOK, side)
        middle = pose.then(Pose(ahead, 0.0, 0.0))
        window = self._window(middle.x, middle.y, around)
        x, y = self._seen_from(pose, window)
        cells = self._state[window]
        beside = _beside(cells % TOUCHED == EDGE)
        cells[beside & (cells == GUESSED)] = UNKNOWN
        rows, columns = np.nonzero((np.abs(y) < x * math.tan(side)) & (cells != FREE) & (cells < TOUCHED))
        if rows.size:
            x, y, state = x[rows, columns], y[rows, columns], cells[rows, columns]
            distances = np.hypot(x, y)
            least = seen_past(distances, np.arctan2(y, x), HALF_CELL, free, angles)
            shown = (least > np.maximum(distances, blind) + HALF_CELL) & (distances <= LOOK + CELL)
            seen = shown & (distances >= blind + HALF_CELL)
            guessed = shown & ~seen & (state == UNKNOWN) & ~beside[rows, columns]
            cells[rows[seen], columns[seen]] = FREE
            cells[rows[guessed], columns[guessed]] = GUESSED

    def _places(self, points: Floats) -> tuple[NDArray[np.int64], ...]:
        """Where the cells of those points (2, n) [m] are kept that lie inside the square."""
        cells = np.floor(points / CELL).astype(np.int64) - np.array(self._corner)[:, None]
        return tuple(cells[:, ((cells >= 0) & (cells < CELLS)).all(axis=0)])

    def _window(self, x: float, y: float, reach: float) -> tuple[slice, slice]:
        """The part of the square that holds all cells within `reach` [m] of x, y [m]."""
        half = math.ceil(reach / CELL)
        row, column = math.floor(x / CELL) - self._corner[0], math.floor(y / CELL) - self._corner[1]
        first = max(row - half, 0), max(column - half, 0)
        return slice(first[0], max(row + half + 1, 0)), slice(first[1], max(column + half + 1, 0))

    def _offsets(self, window: tuple[slice, slice], pose: Pose) -> tuple[Floats, Floats]:
        """How far [m] along the world's x and y the window's rows and columns are from `pose`."""
        rows, columns = (np.arange(*part.indices(CELLS), dtype=np.float64) for part in window)
        x, y = (0.5 + self._corner[0]) * CELL - pose.x, (0.5 + self._corner[1]) * CELL - pose.y
        return rows * CELL + x, columns * CELL + y

    def _seen_from(self, pose: Pose, window: tuple[slice, slice]) -> tuple[Floats, Floats]:
        """The middles [m] of a window's cells, ahead and to the left of `pose`: (rows, columns) each."""
        dx, dy = self._offsets(window, pose)
        cos, sin = math.cos(pose.theta), math.sin(pose.theta)
        return (cos * dx)[:, None] + sin * dy, cos * dy - (sin * dx)[:, None]

    def _move(self, row: int, column: int) -> None:
        """Let the square begin at that cell of the world; what comes in is not known."""
        down, right = row - self._corner[0], column - self._corner[1]
        if down or right:
            before, self._state = self._state, np.full((CELLS, CELLS), UNKNOWN, np.int8)
            self._state[_kept(-down), _kept(-right)] = before[_kept(down), _kept(right)]
            self._corner = (row, column)


def _beside(edges: Mask) -> Mask:
    """Which cells of a window have an edge BESIDE them: in the square around each, by sums over rectangles."""
    reach = round(BESIDE / CELL)
    sums = np.pad(edges, ((reach + 1, reach), (reach + 1, reach))).cumsum(0, np.int16).cumsum(1, np.int16)
    side = 2 * reach + 1
    beside: Mask = sums[side:, side:] - sums[:-side, side:] != sums[side:, :-side] - sums[:-side, :-side]
    return beside


def _kept(shift: int) -> slice:
    """The lines of the square that stay in it when it moves on by `shift`."""
    shift = min(max(shift, -CELLS), CELLS)
    return slice(max(shift, 0), CELLS + min(shift, 0))
