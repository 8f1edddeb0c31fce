"""Low steps up: what no wheel takes stands in the way, though it is lower than the floor's band."""

from __future__ import annotations

import numpy as np

from cliffscan.common.perception.floor_points import FloorPoints, Metres
from cliffscan.common.perception.low_steps import RISE, Sight, low_steps, rows_near


def mark_rises(standing: Metres, points: FloorPoints, outward: int, sight: Sight) -> None:
    """Say in `standing`, in place, how far away [m] the first low step up in each column is; (rows, columns)."""
    region = points.region
    middle = region.shape[1] // 2
    forward, left, up = (axis.rows + axis.columns[middle] for axis in (region.forward, region.left, region.up))
    falls = -up / np.hypot(forward, left)
    steps = low_steps(points.heights, points.distances, rows_near(falls, outward, sight), sight)
    columns = np.flatnonzero(steps.kind == RISE)
    standing[steps.row[columns].astype(np.int64), columns] = steps.distance[columns]
