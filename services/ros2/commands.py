"""ROS messages that come in, as ours. All functions raise CdrError or MessageError."""

import time

import numpy as np

from cliffscan.common.contract.base_messages import Odometry, Velocity
from cliffscan.services.ros2.cdr import Reader
from cliffscan.services.ros2.messages import PLANE
from cliffscan.services.ros2.transforms import heading_of

SOURCE = "ros2"


def twist(reader: Reader, priority: int) -> Velocity:
    """The velocity of a geometry_msgs/Twist, which has no stamp: it is taken for one of now."""
    return _velocity(reader, time.time_ns(), priority)


def twist_stamped(reader: Reader, priority: int) -> Velocity:
    """The velocity of a geometry_msgs/TwistStamped; a stamp of 0 means now, as in ROS."""
    stamp, _frame = reader.header()
    return _velocity(reader, stamp or time.time_ns(), priority)


def odometry(reader: Reader) -> Odometry:
    """What a nav_msgs/Odometry says of the plane."""
    stamp, frame = reader.header()
    child = reader.text()
    x, y, _z, *rotation = reader.numbers("d", 7)
    pose_covariance = reader.numbers("d", 36)
    linear, _y, _z, _roll, _pitch, angular = reader.numbers("d", 6)
    fields = {
        "stamp": stamp,
        "frame": frame,
        "child_frame": child,
        "pose": (x, y, heading_of((rotation[0], rotation[1], rotation[2], rotation[3]))),
        "twist": (linear, angular),
        "pose_covariance": _planar(pose_covariance),
        "twist_covariance": _planar(reader.numbers("d", 36)),
    }
    return Odometry.of(fields)


def _velocity(reader: Reader, stamp: int, priority: int) -> Velocity:
    linear, _y, _z, _roll, _pitch, angular = reader.numbers("d", 6)
    fields = {"stamp": stamp, "linear": linear, "angular": angular, "source": SOURCE, "priority": priority}
    return Velocity.of(fields)


def _planar(covariance: tuple[float, ...]) -> list[float]:
    """The covariance 3 x 3 of x, y and theta in one of six dimensions."""
    return [float(each) for each in np.reshape(covariance, (6, 6))[np.ix_(PLANE, PLANE)].ravel()]
