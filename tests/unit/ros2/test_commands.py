"""What comes from ROS, written by an independent CDR library."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.message import MessageError
from cliffscan.services.ros2 import commands, messages
from cliffscan.services.ros2.cdr import CdrError, Reader
from tests.unit.ros2.test_messages import ODOMETRY

ROS = get_typestore(Stores.ROS2_JAZZY)
MS = 1_000_000  # [ns]


def kind(name):
    return ROS.types[name]


def twist(linear=0.2, angular=-0.5):
    vector = kind("geometry_msgs/msg/Vector3")
    return kind("geometry_msgs/msg/Twist")(vector(linear, 0.1, 0.2), vector(0.3, 0.4, angular))


def written(message, name):
    return Reader(bytes(ROS.serialize_cdr(message, name)))


def stamped(stamp, frame):
    time_of = kind("builtin_interfaces/msg/Time")(stamp // 10**9, stamp % 10**9)
    header = kind("std_msgs/msg/Header")(time_of, frame)
    name = "geometry_msgs/msg/TwistStamped"
    return written(kind(name)(header, twist()), name)


def test_a_twist_is_of_when_it_was_sent():
    reader = Reader(messages.twist(0.2, -0.5), sent=123_456_789_012)
    assert commands.twist(reader, "ros2", 7).stamp == 123_456_789_012


def test_a_twist_that_was_sent_at_an_unknown_time_is_of_now():
    before = time.time_ns()
    velocity = commands.twist(written(twist(), "geometry_msgs/msg/Twist"), "ros2", 7)
    assert before <= velocity.stamp <= time.time_ns()
    assert (velocity.linear, velocity.angular, velocity.source, velocity.priority) == (0.2, -0.5, "ros2", 7)


@pytest.mark.parametrize("frame", ["", "b", "base_link", "a frame with 'ümlaut"])
def test_a_stamped_twist_keeps_its_stamp_whatever_its_frame(frame):
    velocity = commands.twist_stamped(stamped(123_456_789_012, frame), "joystick", 0)
    assert (velocity.stamp, velocity.linear, velocity.angular) == (123_456_789_012, 0.2, -0.5)


def test_a_stamped_twist_without_a_stamp_is_of_now():
    assert abs(commands.twist_stamped(stamped(0, "base_link"), "", 0).stamp - time.time_ns()) < 60_000 * MS


@pytest.mark.parametrize("speed", [math.nan, math.inf, 1e9])
def test_an_impossible_twist_is_refused(speed):
    with pytest.raises(MessageError, match="linear"):
        commands.twist(written(twist(linear=speed), "geometry_msgs/msg/Twist"), "", 0)


def test_bytes_that_are_too_few_are_refused():
    whole = messages.twist(0.2, 0.0)
    for length in range(4, len(whole)):
        with pytest.raises(CdrError, match="ends after"):
            commands.twist(Reader(whole[:length]), "", 0)


@pytest.mark.parametrize("payload", [b"", b"\x00", b"\x00\x00\x00\x00", b"\x00\x03\x00\x00", b"\x93\x01\x02\x03"])
def test_what_is_no_little_endian_cdr_is_refused(payload):
    with pytest.raises(CdrError, match="little-endian CDR"):
        Reader(payload)


def test_a_string_that_is_none_is_refused():
    with pytest.raises(CdrError, match="UTF-8"):
        Reader(b"\x00\x01\x00\x00\x02\x00\x00\x00\xff\x00").text()
    with pytest.raises(CdrError, match="ends after"):
        Reader(b"\x00\x01\x00\x00\xff\xff\xff\xff\xff\x00").text()


def test_odometry_comes_back_as_it_was():
    back = commands.odometry(Reader(messages.odometry(ODOMETRY, "base_link")))
    assert isinstance(back, Odometry)
    np.testing.assert_allclose(back.pose, ODOMETRY.pose)
    exact = {"pose": ODOMETRY.pose}
    assert back.model_copy(update=exact) == ODOMETRY


def turned(*rotation):
    """Odometry of this orientation."""
    message = ROS.deserialize_cdr(messages.odometry(ODOMETRY, "base_link"), "nav_msgs/msg/Odometry")
    quaternion = kind("geometry_msgs/msg/Quaternion")(*rotation)
    moved = replace(message.pose, pose=replace(message.pose.pose, orientation=quaternion))
    return written(replace(message, pose=moved), "nav_msgs/msg/Odometry")


@pytest.mark.parametrize("length", [0.95, 1.0, 1.05])
@pytest.mark.parametrize("heading", [0.5, math.pi / 2, -2.6])
def test_the_heading_does_not_depend_on_the_length_of_the_quaternion(length, heading):
    rotation = 0.0, 0.0, length * math.sin(heading / 2), length * math.cos(heading / 2)
    assert commands.odometry(turned(*rotation)).pose[2] == pytest.approx(heading)


@pytest.mark.parametrize("rotation", [(0,) * 4, (0, 0, 0.5, 0.5), (0, 0, 1, 1), (0, 0, math.nan, 1), (math.inf,) * 4])
def test_odometry_whose_orientation_is_none_is_refused(rotation):
    with pytest.raises(CdrError, match=r"orientation has length .*, expected 1"):
        commands.odometry(turned(*map(float, rotation)))


def test_odometry_without_numbers_is_refused():
    broken = ODOMETRY.model_copy(update={"pose": (math.nan, 0.0, 0.0)})
    with pytest.raises(MessageError, match="pose"):
        commands.odometry(Reader(messages.odometry(broken, "base_link")))
