"""Our messages as those of ROS 2: functions of a message that return CDR, fields in the order of the definition.

Those with a stamp raise CdrError where ROS cannot express it.

Source: common_interfaces and tf2_msgs, of Jazzy.
"""

import math
import struct
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry
from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.services.ros2.cdr import Writer
from cliffscan.services.ros2.transforms import Transform, heading

PLANE = (0, 1, 5)  # x, y and the rotation about z, of the six dimensions of a covariance
NOT_MEASURED = 1e6  # variance of what no sensor measures
BETWEEN = (0.0, 0.0, 0.0)  # of a row of x, y or the rotation about z: its places of the other three
UNMEASURED = [NOT_MEASURED if place % 7 == 0 else 0.0 for place in range(12, 30)]  # the rows of the other three
HEADING_VARIANCE = 0.05  # [rad²] of the gyro's own heading, as kobuki_node has it
HEADING_COVARIANCE = (NOT_MEASURED, 0.0, 0.0, 0.0, NOT_MEASURED, 0.0, 0.0, 0.0, HEADING_VARIANCE)
NOT_KNOWN = (0.0,) * 9  # a covariance
NO_ACCELERATION = (0.0, 0.0, 0.0, -1.0, *(0.0,) * 8)  # none, and of its covariance -1: there is none
FLOATS = np.dtype("<f4")  # of a sequence
COUNT = struct.Struct("<I")  # of its numbers, after what ends at a multiple of 4
FLOAT32, POINT_STEP = 7, 16  # of a PointField; [bytes] of x, y, z and intensity
DENSE = b"\1"  # true: a cloud has no invalid points
POINT_FIELDS = ("x", "y", "z", "intensity")
UNKNOWN, CHARGING, DISCHARGING, FULL = 0, 1, 2, 4  # power_supply_status
SUPPLY = {
    "discharging": DISCHARGING,
    "dock_charging": CHARGING,
    "adapter_charging": CHARGING,
    "dock_charged": FULL,
    "adapter_charged": FULL,
}


def laser_scan(scan: LaserScan, ranges: Ranges, frame: str, range_max: float) -> bytes:
    """A sensor_msgs/LaserScan with the beams of a scan, but other ranges [m]: (beams,)."""
    grid, times = Grid(len(ranges), scan.angle_min, scan.angle_increment), (scan.time_increment, scan.scan_time)
    head = _before_ranges(scan.stamp, frame, grid, times, scan.range_min, range_max)
    intensities = scan.intensities.astype(FLOATS, copy=False).tobytes()
    return b"".join((head, ranges.astype(FLOATS, copy=False).tobytes(), COUNT.pack(len(scan.intensities)), intensities))


@lru_cache(maxsize=1)  # several scans are made of one, and differ in their ranges alone
def _before_ranges(
    stamp: int, frame: str, grid: Grid, times: tuple[float, float], range_min: float, range_max: float
) -> bytes:
    """A sensor_msgs/LaserScan up to the number of its ranges."""
    writer = Writer()
    writer.header(stamp, frame)
    writer.numbers("f", grid.angle_min, grid.angle_max, grid.increment, *times, range_min, range_max)
    writer.numbers("I", grid.beams)
    return writer.payload()


def point_cloud(scan: LaserScan, frame: str) -> bytes:
    """A sensor_msgs/PointCloud2 of a scan's numbers, in its own plane, with the evidence as intensity."""
    (hit,) = np.isfinite(scan.ranges).nonzero()
    points = np.zeros((len(hit), len(POINT_FIELDS)), FLOATS)
    ranges = scan.ranges.take(hit)
    for axis, direction in enumerate(directions(scan.grid())):
        np.multiply(ranges, direction.take(hit), out=points[:, axis])
    if len(scan.intensities):
        points[:, 3] = scan.intensities.take(hit)
    writer = Writer()
    writer.header(scan.stamp, frame)
    writer.numbers("I", 1, len(points))
    writer.part(_point_fields())
    writer.numbers("I", POINT_STEP, POINT_STEP * len(points), points.nbytes)
    return b"".join((writer.payload(), points.tobytes(), DENSE))


@cache
def _point_fields() -> bytes:
    """The sequence of PointField of a cloud, and that its numbers are little-endian."""
    writer = Writer()
    writer.numbers("I", len(POINT_FIELDS))
    for number, name in enumerate(POINT_FIELDS):
        writer.text(name)
        writer.numbers("I", 4 * number)
        writer.numbers("B", FLOAT32)
        writer.numbers("I", 1)
    writer.numbers("?", False)
    return writer.payload()


@lru_cache(maxsize=1)
def directions(grid: Grid) -> NDArray[np.float32]:
    """A metre along each beam, x and y: (2, beams)."""
    angles = grid.angles()
    return np.stack([np.cos(angles), np.sin(angles)]).astype(np.float32)


def odometry(message: Odometry, base_frame: str) -> bytes:
    """A nav_msgs/Odometry."""
    x, y, theta = message.pose
    linear, angular = message.twist
    writer = Writer()
    writer.header(message.stamp, message.frame)
    writer.text(base_frame)
    pose = (x, y, 0.0, *heading(theta), *_covariance(message.pose_covariance))
    writer.numbers("d", *pose, linear, 0.0, 0.0, 0.0, 0.0, angular, *_covariance(message.twist_covariance))
    return writer.payload()


def tf_message(transforms: Sequence[Transform]) -> bytes:
    """A tf2_msgs/TFMessage."""
    writer = Writer()
    writer.numbers("I", len(transforms))
    for each in transforms:
        writer.header(each.stamp, each.parent)
        writer.text(each.child)
        writer.numbers("d", *each.translation, *each.rotation)
    return writer.payload()


def imu(message: Imu, frame: str) -> bytes:
    """A sensor_msgs/Imu: the gyro's heading, its newest sample, and no acceleration."""
    samples: NDArray[np.float32] = message.angular_velocities
    rates = samples[-3:].tolist() if len(samples) else (0.0, 0.0, message.heading_rate)
    writer = Writer()
    writer.header(message.stamp, frame)
    writer.numbers("d", *heading(message.heading), *HEADING_COVARIANCE, *rates, *NOT_KNOWN, *NO_ACCELERATION)
    return writer.payload()


def battery_state(state: BaseState, frame: str) -> bytes:
    """A sensor_msgs/BatteryState; what the base does not measure is NaN or unknown."""
    writer = Writer()
    writer.header(state.stamp, frame)
    writer.numbers("f", state.battery_voltage, *[math.nan] * 5, state.battery_percent / 100.0)
    writer.numbers("B", SUPPLY.get(state.charger, UNKNOWN), UNKNOWN, UNKNOWN)
    writer.numbers("?", True)
    writer.sequence(np.empty(0, np.float32))  # voltages and
    writer.sequence(np.empty(0, np.float32))  # temperatures of cells
    writer.text("")
    writer.text("")
    return writer.payload()


def diagnostic_array(stamp: int, level: int, name: str, text: str, hardware: str, values: Mapping[str, str]) -> bytes:
    """A diagnostic_msgs/DiagnosticArray of one status."""
    writer = Writer()
    writer.header(stamp, "")
    writer.numbers("I", 1)
    writer.numbers("B", level)
    for each in (name, text, hardware):
        writer.text(each)
    writer.numbers("I", len(values))
    for key, value in values.items():
        writer.text(key)
        writer.text(value)
    return writer.payload()


def occupancy_grid(grid: OccupancyGrid) -> bytes:
    """A nav_msgs/OccupancyGrid."""
    x, y, theta = grid.origin
    writer = Writer()
    writer.header(grid.stamp, grid.frame)
    writer.stamp(grid.stamp)
    writer.numbers("f", grid.resolution)
    writer.numbers("I", grid.width, grid.height)
    writer.numbers("d", x, y, 0.0, *heading(theta))
    writer.sequence(grid.data)
    return writer.payload()


def image(message: DepthImage) -> bytes:
    """A sensor_msgs/Image, 16UC1: (height, width) [mm], 0 = no return."""
    writer = Writer()
    writer.header(message.stamp, message.frame)
    writer.numbers("I", message.height, message.width)
    writer.text("16UC1")
    writer.numbers("B", 0)  # little-endian
    writer.numbers("I", 2 * message.width)
    writer.sequence(np.ascontiguousarray(message.depth, "<u2").view(np.uint8).ravel())
    return writer.payload()


def camera_info(message: DepthImage) -> bytes:
    """A sensor_msgs/CameraInfo of an image without distortion."""
    fx, fy, cx, cy = message.intrinsics
    writer = Writer()
    writer.header(message.stamp, message.frame)
    writer.numbers("I", message.height, message.width)
    writer.text("plumb_bob")
    writer.sequence(np.zeros(5))
    writer.numbers("d", fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0)
    writer.numbers("d", 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)  # it is rectified already
    writer.numbers("d", fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0)
    writer.numbers("I", 0, 0, 0, 0, 0, 0)  # no binning, and the region is all of it
    writer.numbers("?", False)
    return writer.payload()


def string(text: str) -> bytes:
    """A std_msgs/String."""
    writer = Writer()
    writer.text(text)
    return writer.payload()


def trigger_response(success: bool, text: str) -> bytes:
    """A std_srvs/Trigger_Response."""
    writer = Writer()
    writer.numbers("?", success)
    writer.text(text)
    return writer.payload()


def twist(linear: float, angular: float) -> bytes:
    """A geometry_msgs/Twist [m/s], [rad/s]."""
    writer = Writer()
    writer.numbers("d", linear, 0.0, 0.0, 0.0, 0.0, angular)
    return writer.payload()


def twist_stamped(stamp: int, frame: str, linear: float, angular: float) -> bytes:
    """A geometry_msgs/TwistStamped [m/s], [rad/s]."""
    writer = Writer()
    writer.header(stamp, frame)
    writer.numbers("d", linear, 0.0, 0.0, 0.0, 0.0, angular)
    return writer.payload()


def _covariance(planar: Sequence[float]) -> tuple[float, ...]:
    """The covariance 6 x 6 of one of x, y and theta, 3 x 3; the other dimensions are not measured."""
    xx, xy, xt, yx, yy, yt, tx, ty, tt = planar
    return (xx, xy, *BETWEEN, xt, yx, yy, *BETWEEN, yt, *UNMEASURED, tx, ty, *BETWEEN, tt)
