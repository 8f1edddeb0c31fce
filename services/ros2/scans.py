"""Three scans for ROS of one fused scan, each safe for those who read it.

A LaserScan of ROS cannot say that something stands at 3 m and the ground is known only up to 1.2 m. A program that
takes a number for the end of free ground would free what nobody saw. So /scan, for SLAM, has a number only where ground
was seen up to it; /scan_marks has every number, to mark with; /scan_clear how far ground was seen, to clear with.
docs/ros2.md has what Karto, Nav2's obstacle layer and its collision monitor do with numbers, +inf and NaN.

All functions return ranges [m]: (beams,), none of them +inf or beyond range_max(slam_range). slam_range [m] is the
distance up to which a SLAM frees ground.
"""

import numpy as np

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.messages import LaserScan

BEYOND = 0.5  # [m] by which range_max exceeds slam_range, so that a number can lie between the two
SHORT = 0.01  # [m] of range_max: the number of a beam that hit nothing
CELL = 0.05  # [m] of a usual map: ground may end so much before a number, as an image's rows do
NAN = np.float32(np.nan)


def range_max(slam_range: float) -> float:
    """Range [m] that no number exceeds; constant, for a SLAM registers a scanner once."""
    return slam_range + BEYOND


def for_slam(scan: LaserScan, slam_range: float) -> Ranges:
    """/scan: whatever stands or ends where ground was seen up to it, or a number beyond slam_range; else NaN."""
    ends = np.fmin(for_marking(scan, slam_range), np.float32(range_max(slam_range) - SHORT))
    seen = scan.up_to("clear") >= np.minimum(ends, np.float32(slam_range)) - np.float32(CELL)
    return np.where(seen, ends, NAN)


def for_marking(scan: LaserScan, slam_range: float) -> Ranges:
    """/scan_marks: every number, whether ground was seen before it or not; else NaN."""
    return np.where(scan.ranges < np.float32(range_max(slam_range)), scan.ranges, NAN)


def for_clearing(scan: LaserScan, slam_range: float, nearest_floor: float) -> Ranges:
    """/scan_clear: how far ground was seen; NaN where that is nearer than nearest_floor [m], where none is in view."""
    free = np.fmin(scan.free(), range_max(slam_range) - SHORT).astype(np.float32)
    return np.where(free >= nearest_floor, free, NAN)
