"""An occupancy grid: beams are cast from the place they were seen from, and each cell counts the odds."""

import logging

import numpy as np
from numpy.typing import NDArray

from examples.slam.beams import Beams
from examples.slam.canvas import Canvas, Span, TooLarge
from examples.slam.pose import Pose
from examples.slam.wire import Map

HIT, MISS = 2.0, -1.2  # log-odds of one look: a cell is occupied, or free, from the first one on
SURE = 4.0  # log-odds beyond which a cell is not made surer, so that it can change again within some looks
MARGIN = 2.0  # [m] added on a side where the map must grow

Floats = NDArray[np.float64]
log = logging.getLogger(__name__)


class OccupancyGrid:
    """Log-odds of cells that are aligned with the map's origin; 0 where nothing is known."""

    def __init__(self, resolution: float) -> None:
        """`resolution`: side of a cell [m]."""
        self._resolution = resolution
        self._odds = Canvas(margin=round(MARGIN / resolution))

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
        try:
            odds = self._odds.window(*map(Span, corner.tolist(), end.tolist()))
        except TooLarge as error:
            log.warning("dropped a scan: %s", error)
            return
        look = np.zeros(odds.shape, np.float32)
        look[tuple(free - corner[:, None])] = MISS
        look[tuple(hits - corner[:, None])] = HIT
        np.clip(odds + look, -SURE, SURE, out=odds)

    def map(self) -> Map:
        """The grid as it is published."""
        odds = self._odds.values
        percent = np.rint(100 / (1 + np.exp(-odds)))
        cells = np.where(odds == 0, -1, percent).astype(np.int8)
        corner = self._odds.columns.first * self._resolution, self._odds.rows.first * self._resolution
        return Map(self._resolution, *corner, cells)

    def _cells(self, points: Floats) -> NDArray[np.int64]:
        """(2, points) row and column, counted from the map's origin, of the cell at each x, y [m]."""
        return np.floor(points[::-1] / self._resolution).astype(np.int64)


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
