"""A depth image as points over the floor, and what each of them is to the robot."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Floats, scan_axes
from cliffscan.common.contract.messages import DepthImage


class Kind(IntEnum):
    """What a point is, by its height."""

    NOTHING = 0  # no usable return
    BELOW = 1  # below the floor band
    FLOOR = 2
    OBSTACLE = 3  # above the floor band and not above the robot
    OVERHEAD = 4  # above the robot


class Bands(NamedTuple):
    """The heights [m] that part the kinds, as the services are configured."""

    floor_band: float = 0.03
    robot_height: float = 0.42


class Cloud(NamedTuple):
    """The points of a depth image in the scan frame: three of (rows, columns) [m], NaN where nothing usable was."""

    ahead: Floats
    left: Floats
    height: Floats


def cloud(image: DepthImage) -> Cloud:
    """The points of `image`; depths outside the sensor's range and rays that lead backward are left out."""
    depth = image.depth * 0.001
    near, far = image.camera.range
    forward, left, up = (axis.table() for axis in scan_axes(image.camera))
    usable = (depth > 0.0) & (depth >= near) & (depth <= far) & (forward > 0.0)
    depth[~usable] = np.nan
    return Cloud(forward * depth, left * depth, up * depth + image.camera.floor.d)


def kinds(points: Cloud, bands: Bands) -> NDArray[np.uint8]:
    """The Kind of each point: (rows, columns)."""
    height = points.height
    found = np.full(height.shape, Kind.NOTHING, np.uint8)
    found[height < -bands.floor_band] = Kind.BELOW
    found[np.abs(height) <= bands.floor_band] = Kind.FLOOR
    found[height > bands.floor_band] = Kind.OBSTACLE
    found[height > bands.robot_height] = Kind.OVERHEAD
    return found
