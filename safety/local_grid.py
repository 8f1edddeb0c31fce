"""What is known of the floor around the robot: free, occupied, an edge, touched, or not known.

A camera 0.30 m high sees no floor nearer than 0.72 m, so an edge vanishes from view just before the robot reaches it.
What the scans showed is therefore kept, in the odometry's frame, until it is seen to be free or lies behind.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.safety.beam_clearance import sector, seen_past
from cliffscan.safety.hull import Disc, Hull
from cliffscan.safety.pose2d import Floats, Pose2D
from cliffscan.safety.visible_floor import VisibleFloor

Mask = NDArray[np.bool_]

CELL = 0.04  # [m]
HALF_CELL = CELL * math.sqrt(0.5)  # [m] from a cell's middle to its corners
MEMORY = 3.0  # [m] what lies farther off is forgotten
CELLS = 2 * round(MEMORY / CELL)
LINES = CELL * np.arange(CELLS, dtype=np.float64)  # [m] of the square's rows, or columns, from the first
NOWHERE = np.empty((2, 0))  # no points
LOOK = 1.5  # [m] around the robot within which floor is seen to be free, and as far as it looks ahead
GUESS_REACH = 0.9  # [m] from the camera up to which floor that it cannot see is guessed: a level one of 0.30 m needs it
BESIDE = 0.2  # [m] along which an edge that is seen may go on where it is not
WIDEST = math.radians(80.0)  # a scan is taken in that far to either side

FREE, GUESSED, UNKNOWN, OCCUPIED, EDGE = range(5)  # GUESSED is free because floor was seen behind it
TOUCHED = 5  # of a GridWindow, whatever was seen there
KINDS = {UNKNOWN: "unseen floor", OCCUPIED: "obstacle", EDGE: "edge"}


class GridWindow(NamedTuple):
    """A copy of a part of the grid, for people."""

    cells: NDArray[np.int8]  # (rows along the odometry's x, columns along its y): FREE to EDGE, or TOUCHED
    x: float  # [m] where the first cell begins
    y: float


class RollingGrid:
    """A square of cells with the robot in the middle one; what leaves the square is forgotten.

    A cell keeps what was `seen` there apart from whether it was `touched`: to forgive a touch forgets nothing seen, and
    what was touched is not free whatever is seen. `start_free` [m] around the place where it begins counts as free:
    somebody put the robot there.
    """

    def __init__(self, pose: Pose2D, start_free: float) -> None:
        self._seen = np.full((CELLS, CELLS), UNKNOWN, np.int8)
        self._touched = np.zeros((CELLS, CELLS), np.bool_)
        self._corner = (0, 0)  # the number, among all cells of the world, of the square's first
        self.follow(pose, Disc(start_free))

    def doubt(self) -> None:
        """Nobody knows what happened since: what was free may not be, what was in the way may still be."""
        self._seen[(self._seen <= GUESSED) & ~self._touched] = UNKNOWN

    def smear(self, heading: float, way: float) -> None:
        """The robot went on by up to `way` [m] along its heading [rad], or back, and nobody knows how far.

        So what was that much farther on may be here: of all that may be in a cell now, the worst is.
        """
        seen, touched = self._seen.copy(), self._touched.copy()
        for step in range(1, math.ceil(min(abs(way), 2.0 * MEMORY) / CELL) + 1):  # beyond, nothing is known any more
            along = math.copysign(step, way)
            across, down = along * math.cos(heading), along * math.sin(heading)
            for row in {math.floor(across), math.ceil(across)}:
                for column in {math.floor(down), math.ceil(down)}:
                    stays, comes = (_kept(row), _kept(column)), (_kept(-row), _kept(-column))
                    there = np.full_like(seen, UNKNOWN)
                    there[comes] = self._seen[stays]
                    np.maximum(seen, there, out=seen)
                    touched[comes] |= self._touched[stays]
        self._seen, self._touched = seen, touched

    def forget(self) -> None:
        """The robot was carried: nothing that was seen or felt says anything of where it stands now."""
        self._seen[:] = UNKNOWN
        self._touched[:] = False

    def follow(self, pose: Pose2D, hull: Hull) -> None:
        """The robot is at `pose` now: its hull stands on floor, and what is far is forgotten.

        Not a cell more is freed than the hull covers: else the robot would creep ahead on floor nobody has seen.
        """
        self._move(math.floor(pose.x / CELL) - CELLS // 2, math.floor(pose.y / CELL) - CELLS // 2)
        near = self._window(pose.x, pose.y, hull.outer)
        seen = self._seen[near]
        if not seen.any():  # FREE is 0: there is nothing to free, as nearly always
            return
        rows, columns = np.nonzero((seen > FREE) & (seen <= UNKNOWN) & ~self._touched[near])
        x, y = self._seen_from(pose, near)
        covered = hull.covers(x[rows, columns], y[rows, columns])
        seen[rows[covered], columns[covered]] = FREE

    def see(self, ranges: Floats, edges: Mask, free: Floats, angles: Floats, pose: Pose2D, floor: VisibleFloor) -> None:
        """Take in a scan made at `pose`: (beams,) each, at evenly spaced angles [rad].

        ranges [m]: numbers are where something is in the way or, where `edges` says so, the floor ends; free [m]: how
        far a beam shows floor. A cell is free when every beam that crosses it shows floor beyond it and the camera can
        see all of it. Where it cannot, nearer than floor begins in its view, a cell in the way stays what it is, and
        one not known is guessed to be free together with the floor behind it, for a hole that begins unseen is first
        reported where the view begins. Not BESIDE an edge, though, which may go on there; and not where the view begins
        beyond GUESS_REACH, for a hole may begin and end before that.
        """
        self.mark(ranges, edges, angles, pose)
        if len(angles) > 1:
            self._free(free, angles, pose, floor)

    def mark(self, ranges: Floats, edges: Mask, angles: Floats, pose: Pose2D) -> None:
        """Take in of such a scan what is in the way."""
        near = np.isfinite(ranges) & (ranges <= 2.0 * MEMORY)
        for which, state in ((near & ~edges, OCCUPIED), (near & edges, EDGE)):
            if which.any():
                hits, ways = ranges[which], angles[which]
                self.occupy(pose.to_world(np.stack([hits * np.cos(ways), hits * np.sin(ways)])), state)

    def occupy(self, points: Floats, state: int = OCCUPIED) -> None:
        """Something is in the way at these points (2, n) [m] of the odometry's frame, as far as they are remembered."""
        self._seen[self._places(points)] = state

    def touch(self, points: Floats) -> None:
        """The robot felt something at these points (2, n) [m]; no scan undoes that, only forgive() and distance."""
        self._touched[self._places(points)] = True

    def forgive(self) -> None:
        """Forget what was touched, but not what was seen at the same place."""
        self._touched[:] = False

    def not_free(self, pose: Pose2D, reach: float, unknown_too: bool) -> Floats:
        """Middles (2, n) [m], in the robot's frame, of the cells that are not free: all within `reach` [m], and more.

        To be asked where the robot is, for LOOK at most: the square ends MEMORY away from there.
        """
        window = self._window(pose.x, pose.y, reach)
        there = (self._seen[window] >= (UNKNOWN if unknown_too else OCCUPIED)) | self._touched[window]
        if not there.any():
            return NOWHERE
        x, y = self._seen_from(pose, window)
        return np.array((x[there], y[there]))

    def around(self, pose: Pose2D, reach: float) -> GridWindow:
        """What is known of the cells within `reach` [m] of `pose` along both axes."""
        window = self._window(pose.x, pose.y, reach)
        cells = np.where(self._touched[window], np.int8(TOUCHED), self._seen[window])
        return GridWindow(
            cells, *(CELL * (part.start + corner) for part, corner in zip(window, self._corner, strict=True))
        )

    def kind_at(self, point: Floats) -> str:
        """What is known of a cell that is not free: (2, 1) [m] in the odometry's frame."""
        place = self._places(point)
        return "what was touched" if self._touched[place][0] else KINDS[int(self._seen[place][0])]

    def _free(self, free: Floats, angles: Floats, pose: Pose2D, floor: VisibleFloor) -> None:
        """Free what beams cross that show floor up to `free` [m]; what was seen free already need not be looked at."""
        side = min(max(-angles[0], angles[-1]), WIDEST)
        ahead, around = sector(LOOK, side)
        middle = pose.then(Pose2D(ahead, 0.0, 0.0))
        window = self._window(middle.x, middle.y, around)
        x, y = self._seen_from(pose, window)
        cells, untouched = self._seen[window], ~self._touched[window]
        beside = _beside(cells == EDGE)
        cells[beside & (cells == GUESSED) & untouched] = UNKNOWN
        rows, columns = np.nonzero((np.abs(y) < x * math.tan(side)) & (cells != FREE) & untouched)
        if rows.size:
            x, y, state = x[rows, columns], y[rows, columns], cells[rows, columns]
            distances, azimuths = np.hypot(x, y), np.arctan2(y, x)
            least = seen_past(distances, azimuths, HALF_CELL, free, angles)
            shown = (least > np.maximum(distances, floor.nearest) + HALF_CELL) & (distances <= LOOK + CELL)
            seen = shown & (distances >= floor.nearest + HALF_CELL) & floor.holds(x, y, HALF_CELL)
            guessable = (distances < GUESS_REACH) & floor.begins_within(azimuths, GUESS_REACH)
            guessed = shown & ~seen & (state == UNKNOWN) & ~beside[rows, columns] & guessable
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

    def _offsets(self, window: tuple[slice, slice], pose: Pose2D) -> tuple[Floats, Floats]:
        """How far [m] along the world's x and y the window's rows and columns are from `pose`."""
        x, y = (0.5 + self._corner[0]) * CELL - pose.x, (0.5 + self._corner[1]) * CELL - pose.y
        return LINES[window[0]] + x, LINES[window[1]] + y

    def _seen_from(self, pose: Pose2D, window: tuple[slice, slice]) -> tuple[Floats, Floats]:
        """The middles [m] of a window's cells, ahead and to the left of `pose`: (rows, columns) each."""
        dx, dy = self._offsets(window, pose)
        cos, sin = math.cos(pose.theta), math.sin(pose.theta)
        return (cos * dx)[:, None] + sin * dy, cos * dy - (sin * dx)[:, None]

    def _move(self, row: int, column: int) -> None:
        """Let the square begin at that cell of the world; what comes in is not known."""
        down, right = row - self._corner[0], column - self._corner[1]
        if down or right:
            stays, comes = (_kept(down), _kept(right)), (_kept(-down), _kept(-right))
            seen, touched = self._seen[stays].copy(), self._touched[stays].copy()
            self._seen[:], self._touched[:] = UNKNOWN, False
            self._seen[comes], self._touched[comes] = seen, touched
            self._corner = (row, column)


def _beside(edges: Mask) -> Mask:
    """Which cells of a window have an edge BESIDE them: in the square around each, by sums over rectangles."""
    if not edges.any():
        return edges
    reach = round(BESIDE / CELL)
    sums = np.pad(edges, ((reach + 1, reach), (reach + 1, reach))).cumsum(0, np.int16).cumsum(1, np.int16)
    side = 2 * reach + 1
    beside: Mask = sums[side:, side:] - sums[:-side, side:] != sums[side:, :-side] - sums[:-side, :-side]
    return beside


def _kept(shift: int) -> slice:
    """The lines of the square that stay in it when it moves on by `shift`."""
    shift = min(max(shift, -CELLS), CELLS)
    return slice(max(shift, 0), CELLS + min(shift, 0))
