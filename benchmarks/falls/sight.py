"""Where scans saw that a robot's middle cannot be: a raster of marks that come with what is seen, and go again."""

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.falls.bases import Size
from cliffscan.common.contract.camera import Floats
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.pose2d import Pose2D as Place
from cliffscan.simulator.world import Pose
from evaluation.truth.beam_truth import Mask

SQUARE = 0.1  # [m] side of the squares that are told to be shut
CELL = SQUARE / 2  # [m] side of the cells that bear marks
REACH = 2.5  # [m] from the camera up to which a scan counts
PAST = 0.1  # [m] by which a beam must look beyond the middle of a cell to see that nothing is there
ENOUGH, MOST = 2, 6  # scans by which a cell is marked, and that are remembered at the most


class Sight:
    """Cells of a floor plan that begins at `low` [m] and has `shape` (rows, columns) squares."""

    def __init__(self, low: tuple[float, float], shape: tuple[int, int], size: Size) -> None:
        self._low = np.array(low)[:, None]
        self._marks = np.zeros((2 * shape[0], 2 * shape[1]), dtype=np.int8)
        self._mount, self._blind = size.view.camera, size.view.floor.nearest
        self._around = size.around
        self._shut: Mask | None = None

    def see(self, pose: Pose, scan: LaserScan) -> None:
        """A scan that was taken while the robot was at `pose`.

        A number marks the cell that it falls in. A mark fades that a beam looks past, to its number or, where it has
        none, REACH; not nearer than the camera sees floor, nor where nothing was seen.
        """
        camera = Place(*pose).then(self._mount)
        ranges, angles = scan.ranges.astype(np.float64), scan.grid().angles()
        near = ranges <= REACH  # no NaN
        hits = camera.to_world(np.stack([ranges[near] * np.cos(angles[near]), ranges[near] * np.sin(angles[near])]))
        hit = np.zeros(self._marks.shape, dtype=bool)
        hit[self._cells(hits)] = True
        self._fade(camera, np.fmin(np.where(np.isnan(ranges), 0.0, ranges), REACH), scan, hit)
        self._marks[hit & (self._marks < MOST)] += 1
        self._shut = None

    @property
    def shut(self) -> Mask:
        """The squares that are too near to a marked cell: (rows, columns)."""
        if self._shut is None:
            self._shut = self._too_near()
        return self._shut

    def _fade(self, camera: Place, past: Floats, scan: LaserScan, hit: Mask) -> None:
        """Take from the marks that were not hit and that a scan looks past; past (beams,) [m]."""
        marked = np.nonzero((self._marks > 0) & ~hit)
        x, y = camera.from_world(self._middles(marked))
        distance, beam = np.hypot(x, y), scan.grid().beam_of(np.arctan2(y, x))
        told = np.where((beam >= 0) & (beam < len(past)), past[beam.clip(0, len(past) - 1)], 0.0)
        gone = (distance >= self._blind) & (distance + PAST < told)
        self._marks[marked[0][gone], marked[1][gone]] -= 1

    def _too_near(self) -> Mask:
        """As `shut`: the middle of a square is where its four cells meet, so cells lie at odd halves around it."""
        reach = math.ceil(self._around / CELL)
        marked = np.pad(self._marks >= ENOUGH, reach)
        rows, columns = self._marks.shape
        shut = np.zeros((rows // 2, columns // 2), dtype=bool)
        for i in range(-reach, reach):
            for j in range(-reach, reach):
                if math.hypot(i + 0.5, j + 0.5) * CELL <= self._around:
                    row, column = reach + 1 + i, reach + 1 + j
                    shut |= marked[row : row + rows : 2, column : column + columns : 2]
        return shut

    def _cells(self, points: Floats) -> tuple[NDArray[np.int64], ...]:
        """Rows and columns of the cells of those points (2, n) [m] that lie inside the plan."""
        cells = np.floor((points - self._low) / CELL).astype(np.int64)
        inside = (cells >= 0).all(axis=0) & (cells < np.array(self._marks.shape)[:, None]).all(axis=0)
        return tuple(cells[:, inside])

    def _middles(self, cells: tuple[NDArray[np.int64], ...]) -> Floats:
        """The middles (2, n) [m] of cells."""
        middles: Floats = self._low + CELL * (0.5 + np.stack(cells))
        return middles
