"""The plug-in on the network: what it hears, what it says, and that it is alive."""

from __future__ import annotations

import json
from types import TracebackType
from typing import Self

import zenoh

from examples.slam import wire
from examples.slam.follow import Follower
from examples.slam.pose import Pose
from examples.slam.settings import Settings
from examples.slam.wire import Map


class Network:
    """A Zenoh session of the plug-in. A context manager: leaving it takes every declaration back."""

    def __init__(self, settings: Settings) -> None:
        """Raises zenoh.ZError where a client finds no router."""
        self._settings = settings
        self._session = zenoh.open(_config(settings))
        self._map = self._publisher("map", "OccupancyGrid", zenoh.Priority.DATA_LOW)
        self._pose = self._publisher("pose", "Pose2D", zenoh.Priority.REAL_TIME)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def feed(self, follower: Follower) -> None:
        """Let the follower hear scan and odometry, and tell everyone that the plug-in works."""
        robot, scan = self._settings.robot, self._settings.scan
        hear = self._session.declare_subscriber
        hear(f"{robot}/{scan}", lambda sample: follower.hear_scan(sample.payload.to_bytes()))
        hear(f"{robot}/base/odom", lambda sample: follower.hear_odometry(sample.payload.to_bytes()))
        self._token = self._session.liveliness().declare_token(f"{robot}/alive/{self._settings.token}")

    def say_map(self, grid: Map, stamp: int) -> None:
        """Publish the map as it was at a time [ns]."""
        self._map.put(wire.write_map(grid, stamp))

    def say_pose(self, pose: Pose, stamp: int) -> None:
        """Publish where the robot was on the map at a time [ns]."""
        self._pose.put(wire.write_pose(pose, stamp))

    def _publisher(self, path: str, message: str, priority: zenoh.Priority) -> zenoh.Publisher:
        return self._session.declare_publisher(
            f"{self._settings.robot}/{self._settings.path(path)}",
            encoding=zenoh.Encoding("application/msgpack").with_schema(f"cliffscan.{message}.v1"),
            priority=priority,
        )


def _config(settings: Settings) -> zenoh.Config:
    """Zenoh's configuration: with endpoints given, nobody else is looked for."""
    asked: dict[str, object] = {
        "mode": settings.mode,
        "connect/endpoints": settings.connect,
        "listen/endpoints": settings.listen,
        "scouting/multicast/enabled": False if settings.connect or settings.listen else None,
        # Where a process may lock little memory, as is usual, Zenoh would lose every map without a word.
        "transport/shared_memory/enabled": False,
    }
    config = zenoh.Config()
    for key, value in asked.items():
        if value not in (None, []):
            config.insert_json5(key, json.dumps(value))
    return config
