"""What the page draws from above: a fused scan, and where the robot is."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.pose2d import Pose2D
from cliffscan.view.packet import packet

MILLIMETRES = 1000.0
FARTHEST = 65_534  # [mm]
FREE = 65_535  # looked, nothing there
UNSEEN = 0


def scene(scan: LaserScan, pose: Pose2D | None, camera: Pose2D) -> bytes:
    """The packet of a scan: ranges and seen floor in millimetres, and the evidence of each beam.

    pose: of the robot in the odometry's frame when the scan was taken; camera: the scan's origin on the robot.
    """
    grid = scan.grid()
    evidence = scan.intensities if len(scan.intensities) else np.zeros(grid.beams)
    header = {
        "kind": "scene",
        "stamp": scan.stamp,
        "angle_min": grid.angle_min,
        "increment": grid.increment,
        "camera": camera,
        "pose": pose,
    }
    arrays: dict[str, NDArray[Any]] = {
        "ranges": millimetres(scan.ranges),
        "clear": millimetres(np.minimum(scan.up_to("clear"), np.float32(scan.range_max))),
        "evidence": evidence.astype(np.uint8),
    }
    return packet(header, arrays)


def millimetres(ranges: Ranges) -> NDArray[np.uint16]:
    """Ranges as REP-117 has them, in whole millimetres of at least 1: (beams,); FREE for +inf, UNSEEN for NaN."""
    finite = np.nan_to_num(ranges * MILLIMETRES, nan=0.0, posinf=0.0)
    rounded = np.clip(np.rint(finite), 1, FARTHEST)
    rounded[np.isposinf(ranges)] = FREE
    rounded[np.isnan(ranges)] = UNSEEN
    whole: NDArray[np.uint16] = rounded.astype(np.uint16)
    return whole
