"""Three scans for ROS of one fused scan, each safe for those who read it.

A LaserScan of ROS cannot say that something stands at 3 m and the ground is known only up to 1.2 m. A program that
takes a number for the end of free ground would free what nobody saw. So /scan, for SLAM, has a number only where ground
was seen up to it; /scan_marks has every number, to mark with; /scan_clear how far ground was seen, to clear with.
docs/ros2.md has what Karto, Nav2's obstacle layer and its collision monitor do with numbers, +inf and NaN.

All functions return ranges [m]: (beams,), none of them +inf or beyond range_max(slam_range). slam_range [m] is the
distance up to which a SLAM frees ground, known [m]: (beams,) how far ground is, by known_ground.
"""

from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.perception.known_ground import CELL, safe_ranges

BEYOND = 0.5  # [m] by which range_max exceeds slam_range, so that a number can lie between the two
SHORT = 0.01  # [m] of range_max: the number of a beam that hit nothing
NAN = np.float32(np.nan)


class KnownScan(NamedTuple):
    """A fused scan, and how far ground is known in it."""

    scan: LaserScan
    known: Ranges


def range_max(slam_range: float) -> float:
    """Range [m] that no number exceeds; constant, for a SLAM registers a scanner once."""
    return slam_range + BEYOND


def for_slam(scan: LaserScan, known: Ranges, slam_range: float) -> Ranges:
    """/scan: whatever stands or ends where ground is known up to it, or a number beyond slam_range; else NaN."""
    return safe_ranges(scan, known, slam_range, beyond=range_max(slam_range) - SHORT)


def for_marking(scan: LaserScan, slam_range: float) -> Ranges:
    """/scan_marks: every number, whether ground was seen before it or not; else NaN."""
    return np.where(scan.ranges < np.float32(range_max(slam_range)), scan.ranges, NAN)


def for_clearing(scan: LaserScan, known: Ranges, slam_range: float, nearest_floor: float) -> Ranges:
    """/scan_clear: how far ground is known; NaN where that is nearer than nearest_floor [m], where none is in view.

    Where no number ends it, it ends a CELL earlier: the last row of an image that shows floor may cover a CELL of it.
    """
    known, cell = np.fmin(known, scan.ranges), np.float32(CELL)
    free = np.where(known >= scan.ranges - cell, known, np.maximum(known - cell, np.float32(0.0)))
    free = np.minimum(free, np.float32(range_max(slam_range) - SHORT))
    return np.where(free >= np.float32(nearest_floor), free, NAN)
