"""An occupancy grid: beams are cast from the place they were seen from, and each cell counts the odds."""

import logging

import numpy as np
from numpy.typing import NDArray

from examples.slam.beams import Beams
from examples.slam.pose import Pose
from examples.slam.wire import Map

HIT, MISS = 2.0, -1.2  # log-odds of one look: a cell is occupied, or free, from the first one on
SURE = 4.0  # log-odds beyond which a cell is not made surer, so that it can change again within some looks
MARGIN = 2.0  # [m] added on a side where the map must grow, so that it need not grow with each scan
LARGEST = 1 << 24  # cells; a map that would be larger has a fault in its poses

Floats = NDArray[np.float64]
Cells = NDArray[np.int64]
log = logging.getLogger(__name__)


class OccupancyGrid:
    """Log-odds of cells that are aligned with the map's origin; 0 where nothing is known. It grows."""

    def __init__(self, resolution: float) -> None:
        """`resolution`: side of a cell [m]."""
        self._resolution = resolution
        self._odds = np.zeros((0, 0), np.float32)  # (rows, columns)
        self._first = np.zeros(2, np.int64)  # row and column of its first cell, counted from the map's origin

    def draw(self, seen: Beams, origin: Pose, near: float = 0.0) -> None:
        """Cast each beam from `origin`: cells on its way are free, the cell at its end is occupied if it hit.

        A cell that one beam hits is not freed by another of the same scan. Nearer than `near` [m] nothing is freed,
        for there a camera on a mast sees no floor. A scan that lies absurdly far away is dropped.
        """
        free = self._cells(_on_the_way(seen, origin, near, self._resolution / 2))
        hits = self._cells(_ends(seen, origin))
        touched = np.concatenate([free, hits], axis=1)
        if not touched.size:
            return
        corner, end = touched.min(axis=1), touched.max(axis=1) + 1
        if not self._grow(corner, end):
            return
        odds = self._odds[tuple(map(slice, corner - self._first, end - self._first))]
        look = np.zeros(odds.shape, np.float32)
        look[tuple(free - corner[:, None])] = MISS
        look[tuple(hits - corner[:, None])] = HIT
        np.clip(odds + look, -SURE, SURE, out=odds)

    def map(self) -> Map:
        """The grid as it is published."""
        percent = np.rint(100 / (1 + np.exp(-self._odds)))
        cells = np.where(self._odds == 0, -1, percent).astype(np.int8)
        y, x = (self._first * self._resolution).tolist()
        return Map(self._resolution, x, y, cells)

    def _grow(self, corner: Cells, end: Cells) -> bool:
        """Make room from a corner (row, column) to before an end; False where that would be absurdly much."""
        shape, margin = np.array(self._odds.shape), round(MARGIN / self._resolution)
        first = self._first if shape.all() else corner
        last = first + shape
        before = np.where((corner < first) | (shape == 0), first - corner + margin, 0)
        after = np.where((end > last) | (shape == 0), end - last + margin, 0)
        if (size := shape + before + after).prod() > LARGEST:
            log.warning("dropped a scan: the map would have %d x %d cells", *size)
            return False
        if before.any() or after.any():
            self._odds, self._first = np.pad(self._odds, np.stack([before, after], axis=1)), first - before
        return True

    def _cells(self, points: Floats) -> Cells:
        """(2, points) row and column, from the map's origin, of the cell at each x, y [m]; the farthest are clipped."""
        return np.clip(np.floor(points[::-1] / self._resolution), -LARGEST, LARGEST).astype(np.int64)


def _on_the_way(seen: Beams, origin: Pose, near: float, step: float) -> Floats:
    """(2, points) x, y [m] on the map every `step` [m] along each beam, as far as it reports the ground to be free."""
    distances = np.arange(near, seen.free.max(initial=0.0), step)
    points = np.stack(
        [
            origin.x + np.cos(seen.angles + origin.theta)[:, None] * distances,
            origin.y + np.sin(seen.angles + origin.theta)[:, None] * distances,
        ]
    )
    return points[:, distances < seen.free[:, None]]


def _ends(seen: Beams, origin: Pose) -> Floats:
    """(2, hits) x, y [m] on the map of the ends of all beams that hit something."""
    angles, distances = seen.angles[seen.hit] + origin.theta, seen.ends[seen.hit]
    return np.stack([origin.x + distances * np.cos(angles), origin.y + distances * np.sin(angles)])
