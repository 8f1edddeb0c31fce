"""The configuration of ros2."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from cliffscan.common.contract import limits
from cliffscan.common.runtime.config import ServiceConfig

NAME = r"[A-Za-z][A-Za-z0-9_]*"
SourceName = Annotated[str, limits.NAME]


class CommandTopic(ServiceConfig):
    """A topic on which velocities come, as Twist or TwistStamped; its table's name is the source of its commands."""

    topic: Annotated[str, Field(pattern=rf"^{NAME}(/{NAME})*$", max_length=200)] = "cmd_vel"
    """The topic below the namespace."""
    priority: Annotated[int, Field(ge=-(2**31), lt=2**31)] = 0
    """Priority of its commands; a higher one takes over at once."""


class Ros2Config(ServiceConfig):
    """Where the node is in the ROS graph, and what its scans are like."""

    domain: Annotated[int, Field(ge=0, le=232)] = 0
    """ROS_DOMAIN_ID of the other nodes."""
    namespace: Annotated[str, Field(pattern=rf"^({NAME}(/{NAME})*)?$", max_length=100)] = ""
    """Namespace of the node and of all its topics, as robot1; empty: none."""
    base_frame: Annotated[str, Field(pattern=r"^[A-Za-z0-9_/.-]+$", max_length=100)] = "base_link"
    """Frame of the floor's point between the wheels; base_footprint, where the robot's base_link is above the floor."""
    base: Literal["cliffscan", "external"] = "cliffscan"
    """What drives the base. external: a base that ROS drives; its /odom is received, and /cmd_vel_safe published."""
    slam_range: Annotated[float, Field(gt=0, le=100)] = 4.0
    """Distance [m] up to which a SLAM shall free ground: its own greatest range, as max_laser_range of slam_toolbox."""
    scan_height: Annotated[float, Field(ge=0, le=1)] = 0.12
    """Height [m] above the floor of the scans' frame. On the floor, any tilt of the robot puts obstacles below it."""
    commands: Annotated[dict[SourceName, CommandTopic], Field(default_factory=lambda: {"ros2": CommandTopic()})]
    """Topics that drive, one table [ros2.commands.SOURCE] each; without any there is /cmd_vel, with the source ros2."""

    @field_validator("commands")
    @classmethod
    def _topics(cls, commands: dict[str, CommandTopic]) -> dict[str, CommandTopic]:
        named = [each.topic for each in commands.values()]
        if twice := {name for name in named if named.count(name) > 1}:
            raise ValueError(f"{', '.join(sorted(twice))} is the topic of two sources: give each a topic of its own")
        return commands
