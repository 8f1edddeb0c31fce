"""What ROS nodes send and ask for, as ours."""

import math
import time

import numpy as np

from cliffscan.common.contract.base_messages import Odometry, Velocity
from cliffscan.common.contract.topics import command
from cliffscan.common.runtime.bus import Bus
from cliffscan.services.ros2.cdr import CdrError, Reader
from cliffscan.services.ros2.messages import PLANE, trigger_response
from cliffscan.services.ros2.transforms import Quaternion, heading_of

ANSWER_WITHIN = 1.0  # [s]


def twist(reader: Reader, source: str, priority: int) -> Velocity:
    """The velocity of a geometry_msgs/Twist. It has no stamp: it is of when it was sent, or else of now.

    One that waited in an outage is as old as it is. Raises CdrError or MessageError, as all that read do.
    """
    return _velocity(reader, reader.sent or time.time_ns(), source, priority)


def twist_stamped(reader: Reader, source: str, priority: int) -> Velocity:
    """The velocity of a geometry_msgs/TwistStamped; a stamp of 0 means now, as in ROS."""
    stamp, _frame = reader.header()
    return _velocity(reader, stamp or time.time_ns(), source, priority)


def odometry(reader: Reader) -> Odometry:
    """What a nav_msgs/Odometry says of the plane."""
    stamp, frame = reader.header()
    child = reader.text()
    x, y, _z = reader.numbers("d", 3)
    rotation = _rotation(reader)
    pose_covariance = reader.numbers("d", 36)
    linear, _y, _z, _roll, _pitch, angular = reader.numbers("d", 6)
    fields = {
        "stamp": stamp,
        "frame": frame,
        "child_frame": child,
        "pose": (x, y, heading_of(rotation)),
        "twist": (linear, angular),
        "pose_covariance": _planar(pose_covariance),
        "twist_covariance": _planar(reader.numbers("d", 36)),
    }
    return Odometry.of(fields)


def trigger(bus: Bus, name: str) -> bytes:
    """Pass a std_srvs/Trigger on to the base as its command `name`; the base's answer, as a response."""
    answer = bus.ask(command(name), {}, ANSWER_WITHIN)
    if answer is None:
        return trigger_response(
            success=False, text=f"nobody answers {command(name)}: no base is running, or keys forbid it"
        )
    return trigger_response(bool(answer.get("ok")), str(answer.get("message", "")))


def _velocity(reader: Reader, stamp: int, source: str, priority: int) -> Velocity:
    linear, _y, _z, _roll, _pitch, angular = reader.numbers("d", 6)
    fields = {"stamp": stamp, "linear": linear, "angular": angular, "source": source, "priority": priority}
    return Velocity.of(fields)


def _rotation(reader: Reader) -> Quaternion:
    """A geometry_msgs/Quaternion, which was rounded; one that is far from length 1 tells no heading."""
    x, y, z, w = reader.numbers("d", 4)
    length = math.hypot(x, y, z, w)
    if not 0.9 < length < 1.1:
        raise CdrError(f"orientation has length {length:g}, expected 1: have its driver set it")
    return x / length, y / length, z / length, w / length


def _planar(covariance: tuple[float, ...]) -> list[float]:
    """The covariance 3 x 3 of x, y and theta in one of six dimensions."""
    return [float(each) for each in np.reshape(covariance, (6, 6))[np.ix_(PLANE, PLANE)].ravel()]
