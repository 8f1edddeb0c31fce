"""The roles of a secured network. Each role is one row: it publishes and receives rows of topics.py.

A role is the common name of a certificate. The rules that a secured router keeps follow from this table, and so does
the table in docs/security.md. What is in no row is refused. A row holds below each of the names() of a robot.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from cliffscan.common.contract.topics import (
    BASE_STATE,
    DEPTH,
    DESCRIPTION,
    IMU,
    MAP,
    MAP_OF_PLUGIN,
    ODOMETRY,
    POSE,
    POSE_OF_PLUGIN,
    SAFETY,
    SCAN,
    SCAN_FUSED,
    SCAN_NEGATIVE,
    SCAN_OF_METHOD,
    SCAN_POSITIVE,
    SCAN_SAFE,
    STATUS,
    TOPICS,
    VELOCITY,
    VELOCITY_SAFE,
    WORKSTATION,
    Topic,
    scan,
)

ROUTER, WORKSTATION_ROUTER = "router", "router-workstation"
ROS_NODES = "ros2-nodes"
SENSOR = "sensor-"  # and the last part of its scan's key
SENSOR_NAME = re.compile(r"[A-Za-z0-9_.-]+")
ANY_COMMAND = ("*",)
BASE = (ODOMETRY, BASE_STATE, SAFETY)
FUSED = (SCAN_FUSED, SCAN_SAFE)
SCANS = (SCAN_POSITIVE, SCAN_NEGATIVE, SCAN_OF_METHOD, *FUSED, SCAN)
MAPS = (MAP, MAP_OF_PLUGIN, POSE, POSE_OF_PLUGIN)

Rows = tuple[Topic[Any], ...]


class Ros(Enum):
    """What a role may in the ROS 2 domain of its robot, in which no node is guarded from another."""

    NOTHING = "nothing"
    RECEIVE = "receives"
    ALL = "all"


@dataclass(frozen=True)
class Role:
    """A row.

    services: whose liveliness token and status it may publish; `$*` is wild within a name.
    asks, answers: the base commands it may send, and those it executes; `*` is any.
    wild: whether it may subscribe to `**`, of which it gets what it may receive.
    """

    name: str
    what: str
    publishes: Rows = ()
    receives: Rows = ()
    services: tuple[str, ...] = ()
    asks: tuple[str, ...] = ()
    answers: tuple[str, ...] = ()
    wild: bool = False
    ros: Ros = Ros.NOTHING


def _service(
    name: str,
    what: str,
    publishes: Rows,
    receives: Rows = (),
    services: tuple[str, ...] = (),
    answers: tuple[str, ...] = (),
    ros: Ros = Ros.NOTHING,
) -> Role:
    """The role of a service, which publishes its own token and status, or those of `services`."""
    return Role(name, what, publishes, receives, services or (name,), answers=answers, ros=ros)


PERCEPTION = ("perception", "negative", "positive", "fuse")

ROLES: tuple[Role, ...] = (
    _service("capture", "the camera", (DEPTH, DESCRIPTION), (SCAN_FUSED, DESCRIPTION), ros=Ros.RECEIVE),
    _service("negative", "negative obstacles", (SCAN_NEGATIVE, SCAN_OF_METHOD), (DEPTH,)),
    _service("positive", "positive obstacles", (SCAN_POSITIVE,), (DEPTH, DESCRIPTION)),
    _service("fuse", "one scan of all", FUSED, (SCAN_POSITIVE, SCAN_NEGATIVE, SCAN)),
    _service(
        "perception",
        "negative, positive and fuse in one process",
        (SCAN_NEGATIVE, SCAN_OF_METHOD, SCAN_POSITIVE, *FUSED),
        (DEPTH, DESCRIPTION, SCAN_FUSED, SCAN, STATUS),
        services=PERCEPTION,
    ),
    _service(
        "kobuki", "base and gate", (*BASE, IMU, DESCRIPTION), (VELOCITY, SCAN_FUSED, DESCRIPTION), answers=ANY_COMMAND
    ),
    _service(
        "gate",
        "the gate for a base of any make",
        (VELOCITY_SAFE, SAFETY, DESCRIPTION),
        (VELOCITY, ODOMETRY, BASE_STATE, SCAN_FUSED, DESCRIPTION),
        answers=ANY_COMMAND,
    ),
    Role(
        "base",
        "the driver of a base of any make",
        (ODOMETRY, BASE_STATE, IMU),
        (VELOCITY_SAFE, SAFETY),
    ),
    Role(
        "ros2",
        "ROS 2",
        (VELOCITY, ODOMETRY),
        TOPICS,
        services=("ros2",),
        asks=("stop",),
        ros=Ros.ALL,
    ),
    Role(ROS_NODES, "the nodes of a ROS 2 stack", ros=Ros.ALL),
    Role(
        "driver", "what drives: a planner, a person", (VELOCITY,), (*BASE, *SCANS, *MAPS, DESCRIPTION), asks=ANY_COMMAND
    ),
    Role("operator", "a person who commands and does not drive", (), TOPICS, asks=ANY_COMMAND, wild=True),
    Role("slam", "a SLAM plug-in", MAPS, (*SCANS, ODOMETRY, DESCRIPTION), services=("slam", "slam-$*")),
    Role("viewer", "a look", (), (*SCANS, *BASE, IMU, STATUS, *MAPS, DESCRIPTION), wild=True),
    Role("recorder", "a recording", (), TOPICS, wild=True),
)

_TO_ROBOT = (SCAN_POSITIVE, SCAN_NEGATIVE, SCAN_OF_METHOD, *FUSED, VELOCITY)
_FROM_ROBOT = (DEPTH, DESCRIPTION, *BASE, IMU, *SCANS)

# What a router admits from the other one, by its own role: neither passes on what the other's side must not publish.
NEIGHBOURS: Mapping[str, Role] = {
    ROUTER: Role(
        WORKSTATION_ROUTER,
        "the workstation's router",
        _TO_ROBOT,
        (*_FROM_ROBOT, STATUS),
        services=(*PERCEPTION, "ros2", "router-$*"),
        asks=("stop",),
        wild=True,
        ros=Ros.ALL,
    ),
    WORKSTATION_ROUTER: Role(
        ROUTER,
        "the robot's router",
        _FROM_ROBOT,
        (*_TO_ROBOT, STATUS),
        services=("*",),
        answers=("stop",),
        wild=True,
        ros=Ros.ALL,
    ),
}


def names(robot: str) -> tuple[str, str]:
    """For which names a robot's keys are good: its own, and that of a perception that works for the robot's.

    What is published below the second reaches nothing but that perception, and by it what its role reaches anyway.
    """
    return robot, f"{robot}/{WORKSTATION}"


def sensor(name: str) -> Role:
    """The role of another sensor, an extra input of fuse: `scan/<name>` alone is its own."""
    return Role(f"{SENSOR}{name}", "another sensor", (scan(f"{SCAN.prefix}/{name}"),))


def is_sensor(role: str) -> bool:
    """Whether a role's name is that of another sensor, whose scan is no service's."""
    name = role.removeprefix(SENSOR)
    taken = {topic.path for topic in TOPICS}
    return role != name and bool(SENSOR_NAME.fullmatch(name)) and f"{SCAN.prefix}/{name}" not in taken


def role_names() -> list[str]:
    """The certificates of a robot that has no further sensor."""
    return [ROUTER, WORKSTATION_ROUTER, *(role.name for role in ROLES)]


def role_named(name: str) -> Role | None:
    """The row of a role that is no router's; None where there is none."""
    if is_sensor(name):
        return sensor(name.removeprefix(SENSOR))
    return next((role for role in ROLES if role.name == name), None)


def may_publish(role: Role, path: str) -> bool:
    """Whether a role may publish at a path below the robot's name."""
    path = path.removeprefix(f"{WORKSTATION}/")
    return any(_covers(topic, path) for topic in role.publishes) or path in _statuses(role)


def may_receive(role: Role, path: str) -> bool:
    """Whether a role may subscribe to a path below the robot's name."""
    path = path.removeprefix(f"{WORKSTATION}/")
    return (role.wild and "*" in path) or any(_covers(topic, path) for topic in role.receives)


def _covers(topic: Topic[Any], path: str) -> bool:
    """Whether a row stands for the path."""
    if topic.path == topic.prefix:
        return path == topic.path
    family, _, name = path.rpartition("/")
    return family == topic.prefix and name != "**"


def _statuses(role: Role) -> list[str]:
    return [STATUS.named(service).path for service in role.services]
