"""Every key that carries messages: one row a topic, from which the bus, the services and the wire page follow."""

import re
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache
from typing import Any, Generic, Self, TypeVar

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry, SafetyState, Velocity
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.limits import LARGEST
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.message import Message
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus

M = TypeVar("M", bound=Message)
WORKSTATION = "workstation"  # beginning of the paths of a perception that works for a robot's
ROBOT_NAME = re.compile(r"[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*")


class Qos(Enum):
    """How a sample travels. All are dropped rather than block their publisher when a link is full."""

    BULK = "large, may be dropped, gives way to everything else"
    REAL_TIME = "small, leaves at once, before everything else"
    STATUS = "small, in no hurry"


@dataclass(frozen=True)
class Topic(Generic[M]):
    """A row: a key below the robot's name, its message, how often it comes, how it travels, and what publishes it.

    A path that ends in `<...>` stands for a family of keys. What is latched is kept for whoever asks for it later.
    """

    path: str
    message: type[M]
    rate: str
    qos: Qos
    writer: str
    latched: bool = False

    @property
    def prefix(self) -> str:
        """The path, of a family without the part that differs."""
        return self.path.partition("/<")[0]

    def named(self, name: str) -> Self:
        """The topic of a family with this name."""
        return replace(self, path=f"{self.prefix}/{name}")

    def key(self, robot: str) -> str:
        """The full Zenoh key."""
        return f"{robot}/{self.path}"


DEPTH = Topic("camera/depth", DepthImage, "30 Hz", Qos.BULK, "capture")
DESCRIPTION = Topic(
    "description",
    RobotDescription,
    "once, on change, and to whoever asks",
    Qos.STATUS,
    "capture: `camera`; kobuki or gate: `body`",
    latched=True,
)
SCAN_POSITIVE = Topic("scan/positive", LaserScan, "per frame", Qos.REAL_TIME, "positive")
SCAN_OF_METHOD = Topic(
    "scan/negative/<method>",
    LaserScan,
    "per frame",
    Qos.REAL_TIME,
    "negative, each method that is configured or has subscribers",
)
SCAN_NEGATIVE = Topic("scan/negative", LaserScan, "per frame", Qos.REAL_TIME, "negative, algorithm 3 over its methods")
SCAN_FUSED = Topic(
    "scan/fused",
    LaserScan,
    "per frame",
    Qos.REAL_TIME,
    "fuse, algorithm 3 over positive, negative and extra inputs",
)
SCAN_SAFE = Topic(
    "scan/safe",
    LaserScan,
    "per frame",
    Qos.REAL_TIME,
    "fuse, while it has subscribers: `scan/fused` for whatever reads `ranges` alone",
)
SCAN = Topic("scan/<name>", LaserScan, "any", Qos.REAL_TIME, "any other sensor, an extra input of fuse")
ODOMETRY = Topic("base/odom", Odometry, "50 Hz", Qos.REAL_TIME, "kobuki, or the driver of a base of any make")
BASE_STATE = Topic(
    "base/state", BaseState, "50 Hz", Qos.REAL_TIME, "kobuki, or the driver of a base of any make with contacts"
)
IMU = Topic("base/imu", Imu, "per base packet", Qos.REAL_TIME, "kobuki")
VELOCITY = Topic("base/cmd_vel", Velocity, "any", Qos.REAL_TIME, "whatever drives")
VELOCITY_SAFE = Topic("base/cmd_vel_safe", Velocity, "per decision", Qos.REAL_TIME, "gate, for a base of any make")
SAFETY = Topic("base/safety", SafetyState, "on change and 1 Hz", Qos.REAL_TIME, "kobuki or gate")
MAP = Topic("map", OccupancyGrid, "1 Hz at most", Qos.BULK, "a SLAM plug-in")
MAP_OF_PLUGIN = Topic("map/<name>", OccupancyGrid, "1 Hz at most", Qos.BULK, "one of several SLAM plug-ins")
POSE = Topic("pose", Pose2D, "per scan", Qos.REAL_TIME, "a SLAM plug-in")
POSE_OF_PLUGIN = Topic("pose/<name>", Pose2D, "per scan", Qos.REAL_TIME, "one of several SLAM plug-ins")
STATUS = Topic("status/<service>", ServiceStatus, "1 Hz", Qos.STATUS, "every service")

# every row above
TOPICS: tuple[Topic[Any], ...] = tuple(row for row in list(vars().values()) if isinstance(row, Topic))


def scan(path: str) -> Topic[LaserScan]:
    """A laser scan on a key of one's own, as `lidar/front`."""
    return replace(SCAN, path=path)


def at_workstation(topic: Topic[M]) -> Topic[M]:
    """The topic of a perception on a workstation, which runs with --robot ROBOT/workstation, for the robot's."""
    return replace(topic, path=f"{WORKSTATION}/{topic.path}")


def command(name: str) -> str:
    """Path at which the base answers a command."""
    return f"base/command/{name}"


def alive(service: str) -> str:
    """Path of a service's liveliness token; of `service/name` that of one of several processes that would be it."""
    return f"alive/{service}"


def topic_at(path: str) -> Topic[Any] | None:
    """The row of a key's path below the robot's name; None where the contract has none."""
    path = path.removeprefix(f"{WORKSTATION}/")
    for topic in TOPICS:
        if path == topic.prefix or path.startswith(topic.prefix + "/"):
            return topic
    return None


def message_at(path: str) -> type[Message] | None:
    """The message at a key's path below the robot's name; None where the contract has none."""
    topic = topic_at(path)
    return topic.message if topic else None


@lru_cache(1024)  # it is asked for every sample
def most_bytes(path: str) -> int:
    """How large a payload may be at a key's path below the robot's name."""
    message = message_at(path)
    return message.most_bytes() if message else LARGEST
