"""A scan from elsewhere on the robot, as the camera's beams would have seen it."""

import numpy as np

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Floats

ROUNDING = 1e-9  # [rad]


def resample(ranges: Ranges, angles: Floats, increment: float, pose: tuple[float, float, float], grid: Grid) -> Ranges:
    """Ranges [m] on `grid` of what a scanner at `pose` (x, y [m], yaw [rad]) measured: (beams,); +inf elsewhere.

    ranges: (n,) [m], only numbers count; angles: (n,) [rad] in the scanner's frame. A reading fills its whole
    increment [rad], so that a scan coarser than the grid leaves no gaps between its beams.
    """
    x, y, yaw = pose
    measured = np.isfinite(ranges)
    distance = ranges[measured].astype(np.float64)
    headings = yaw + angles[measured] + np.array([[-0.5], [0.0], [0.5]]) * increment  # both ends and the middle
    ahead, left = x + distance * np.cos(headings), y + distance * np.sin(headings)
    azimuths = np.arctan2(left, ahead)
    return _nearest(np.hypot(ahead, left).min(axis=0), azimuths.min(axis=0), azimuths.max(axis=0), grid)


def _nearest(distance: Floats, right: Floats, left: Floats, grid: Grid) -> Ranges:
    """The nearest of the arcs at `distance` [m] from azimuth `right` to `left` [rad], in each beam."""
    first = np.maximum(grid.beam_of(right), 0)
    last = np.minimum(grid.beam_of(left - ROUNDING), grid.beams - 1)  # an arc that ends where a beam begins misses it
    seen = (first <= last) & (left - right < np.pi)  # an arc across the back of the robot seems to go all round
    counts = (last - first + 1)[seen]
    starts = np.cumsum(counts) - counts
    beams = np.repeat(first[seen] - starts, counts) + np.arange(counts.sum())
    nearest = np.full(grid.beams, np.inf, np.float32)
    np.minimum.at(nearest, beams, np.repeat(distance[seen], counts).astype(np.float32))
    return nearest
