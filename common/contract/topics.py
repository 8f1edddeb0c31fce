"""Every key, its message and its quality of service, in one table."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum
from typing import Any, Generic, TypeVar

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry, SafetyState, Velocity
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.limits import LARGEST
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.message import Message
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus

M = TypeVar("M", bound=Message)
ROBOT_NAME = re.compile(r"[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*")


class Qos(Enum):
    """How a sample travels. All are dropped rather than block their publisher when a link is full."""

    BULK = "large, may be dropped, gives way to everything else"
    REAL_TIME = "small, leaves at once, before everything else"
    STATUS = "small, in no hurry"


@dataclass(frozen=True)
class Topic(Generic[M]):
    """A key below the robot's name, what is said there, and how it travels."""

    path: str
    message: type[M]
    qos: Qos

    def key(self, robot: str) -> str:
        """The full Zenoh key."""
        return f"{robot}/{self.path}"


DEPTH = Topic("camera/depth", DepthImage, Qos.BULK)
SCAN_POSITIVE = Topic("scan/positive", LaserScan, Qos.REAL_TIME)
SCAN_NEGATIVE = Topic("scan/negative", LaserScan, Qos.REAL_TIME)
SCAN_FUSED = Topic("scan/fused", LaserScan, Qos.REAL_TIME)
ODOMETRY = Topic("base/odom", Odometry, Qos.REAL_TIME)
BASE_STATE = Topic("base/state", BaseState, Qos.REAL_TIME)
IMU = Topic("base/imu", Imu, Qos.REAL_TIME)
VELOCITY = Topic("base/cmd_vel", Velocity, Qos.REAL_TIME)
SAFETY = Topic("base/safety", SafetyState, Qos.REAL_TIME)
DESCRIPTION = Topic("description", RobotDescription, Qos.STATUS)
MAP = Topic("map", OccupancyGrid, Qos.BULK)
POSE = Topic("pose", Pose2D, Qos.REAL_TIME)
TOPICS: tuple[Topic[Any], ...] = (DEPTH, ODOMETRY, BASE_STATE, IMU, VELOCITY, SAFETY, DESCRIPTION, MAP, POSE)


def scan(path: str) -> Topic[LaserScan]:
    """A laser scan on a key of one's own, as `scan/lidar`."""
    return Topic(path, LaserScan, Qos.REAL_TIME)


def scan_negative(method: str) -> Topic[LaserScan]:
    """The scan of one method of `negative`."""
    return scan(f"{SCAN_NEGATIVE.path}/{method}")


def status(service: str) -> Topic[ServiceStatus]:
    """How a service fares."""
    return Topic(f"status/{service}", ServiceStatus, Qos.STATUS)


def command(name: str) -> str:
    """Path at which the base answers a command."""
    return f"base/command/{name}"


def alive(service: str) -> str:
    """Path of a service's liveliness token."""
    return f"alive/{service}"


def message_at(path: str) -> type[Message] | None:
    """What is said at a key's path below the robot's name; None where the contract does not say."""
    named: dict[str, type[Message]] = {topic.path: topic.message for topic in TOPICS}
    for prefix, message in (named | {"scan": LaserScan, "status": ServiceStatus}).items():
        if path == prefix or path.startswith(prefix + "/"):
            return message
    return None


def most_bytes(path: str) -> int:
    """How large a payload may be at a key's path below the robot's name."""
    message = message_at(path)
    return message.most_bytes() if message else LARGEST
