"""What ROS programs make of a LaserScan: small models of their source, which know ranges and nothing of `clear`.

Each draws on a grid of 5 cm cells; its cells() are int8 as a map has them: -1 unknown, 0 free, 100 occupied.
"""

from typing import NamedTuple

import numpy as np

CELL = 0.05  # [m]
UNKNOWN, FREE, OCCUPIED = -1, 0, 100


class Scan(NamedTuple):
    """The fields of a sensor_msgs/LaserScan that count, and the pose (x, y, yaw) of its frame."""

    ranges: np.ndarray
    angles: np.ndarray
    range_max: float
    pose: tuple[float, float, float]

    def points(self, distances):
        """Places (..., 2) [m] of each beam at distances (..., beams)."""
        x, y, yaw = self.pose
        return np.stack([x + distances * np.cos(yaw + self.angles), y + distances * np.sin(yaw + self.angles)], axis=-1)


class Area:
    """A square grid whose first cell's corner is at (low, low) [m]."""

    def __init__(self, low, high) -> None:
        self.low, self.side = low, round((high - low) / CELL)

    def cells(self, points):
        """Flat number of each point's cell; points outside are put at the border."""
        place = np.clip(((points - self.low) / CELL).astype(int), 0, self.side - 1)
        return place[..., 1] * self.side + place[..., 0]

    def lines(self, scan, start, ends):
        """The cells that the beams cross from start to their ends (beams,) [m], each once a beam; NaN crosses none."""
        distances = np.arange(start, np.nanmax(ends, initial=start), CELL / 4)[:, None]
        cells = self.cells(scan.points(distances))
        crossed = distances < ends
        crossed[1:] &= cells[1:] != cells[:-1]
        return cells[crossed]


class Karto:
    """slam_toolbox's map, by Karto's OccupancyGrid: AddScan, RayTrace, UpdateCell.

    A number below the range threshold (max_laser_range) frees what lies before it and marks its end; one from there to
    range_max is cut to the threshold and marks nothing; NaN, infinity and what is not below range_max are left out. A
    cell with two passes or more is occupied from a tenth of hits on, else free.
    """

    LEAST_PASSES, LEAST_HITS = 2, 0.1

    def __init__(self, area, max_laser_range) -> None:
        self._area, self._threshold = area, max_laser_range
        self._passes = np.zeros(area.side**2)
        self._hits = np.zeros(area.side**2)

    def add(self, scan) -> None:
        ranges = np.where(scan.ranges < scan.range_max, scan.ranges, np.nan)
        np.add.at(self._passes, self._area.lines(scan, 0.0, np.minimum(ranges, self._threshold)), 1)
        marked = ranges < self._threshold
        cells = self._area.cells(scan.points(np.where(marked, ranges, 0.0))[marked])
        np.add.at(self._passes, cells, 1)
        np.add.at(self._hits, cells, 1)

    def cells(self):
        known = self._passes >= self.LEAST_PASSES
        occupied = self._hits >= self.LEAST_HITS * self._passes
        return np.where(known, np.where(occupied, OCCUPIED, FREE), UNKNOWN).astype(np.int8)


class ObstacleLayer:
    """Nav2's layer with a source that marks and one that clears, or one that does both: ObstacleLayer::updateBounds.

    First all clearing sources free the cells from raytrace_min_range to their number, raytrace_max_range at most, then
    all marking ones mark their numbers up to obstacle_max_range. NaN and, without inf_is_valid, infinity are dropped.
    """

    def __init__(self, area, farthest, raytrace_min_range) -> None:
        self._area, self._farthest, self._nearest = area, farthest, raytrace_min_range
        self._cells = np.full(area.side**2, UNKNOWN, np.int8)

    def update(self, marks, clears) -> None:
        ends = np.where(np.isfinite(clears.ranges), np.minimum(clears.ranges, self._farthest), np.nan)
        self._cells[self._area.lines(clears, self._nearest, ends)] = FREE
        near = np.isfinite(marks.ranges) & (marks.ranges <= self._farthest)
        self._cells[self._area.cells(marks.points(np.where(near, marks.ranges, 0.0))[near])] = OCCUPIED

    def cells(self):
        return self._cells.copy()


def collision_monitor_points(scan, range_min=0.0):
    """The points (n, 2) that the collision monitor sees: nav2_collision_monitor's Scan::getData."""
    valid = (scan.ranges >= range_min) & (scan.ranges <= scan.range_max)
    return scan.points(np.where(valid, scan.ranges, 0.0))[valid]
