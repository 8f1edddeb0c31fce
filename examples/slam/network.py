"""The plug-in on the network: what it subscribes to, what it publishes, and that it is alive."""

import json
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

    def __exit__(self, *_: object) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def feed(self, follower: Follower) -> None:
        """Let the follower receive scan, odometry and description, and show everyone that the plug-in works.

        The description is kept by its publishers: they are asked for it whenever a service comes alive.
        """
        robot, scan = self._settings.robot, self._settings.scan
        description = f"{robot}/description"

        def described(sample: zenoh.Sample) -> None:
            follower.receive_description(sample.payload.to_bytes())

        def answered(reply: zenoh.Reply) -> None:
            if reply.ok:
                described(reply.ok)

        def ask(_alive: zenoh.Sample) -> None:
            self._session.get(description, answered, consolidation=zenoh.ConsolidationMode.NONE)

        subscribe = self._session.declare_subscriber
        subscribe(f"{robot}/{scan}", lambda sample: follower.receive_scan(sample.payload.to_bytes()))
        subscribe(f"{robot}/base/odom", lambda sample: follower.receive_odometry(sample.payload.to_bytes()))
        subscribe(description, described)
        self._session.liveliness().declare_subscriber(f"{robot}/alive/*", ask, history=True)
        self._token = self._session.liveliness().declare_token(f"{robot}/alive/{self._settings.token}")

    def publish_map(self, grid: Map, stamp: int) -> None:
        """Publish the map as it was at a time [ns]."""
        self._map.put(wire.write_map(grid, stamp))

    def publish_pose(self, pose: Pose, stamp: int) -> None:
        """Publish where the robot was on the map at a time [ns]."""
        self._pose.put(wire.write_pose(pose, stamp))

    def _publisher(self, path: str, message: str, priority: zenoh.Priority) -> zenoh.Publisher:
        return self._session.declare_publisher(
            f"{self._settings.robot}/{self._settings.path(path)}",
            encoding=zenoh.Encoding("application/msgpack").with_schema(f"cliffscan.{message}.v1"),
            priority=priority,
        )


def _config(settings: Settings) -> zenoh.Config:
    """Zenoh's configuration: with endpoints given, nobody else is looked for. Raises zenoh.ZError."""
    asked: dict[str, object] = {
        "mode": settings.mode,
        "connect/endpoints": settings.connect,
        "listen/endpoints": settings.listen,
        "scouting/multicast/enabled": False if settings.connect or settings.listen else None,
        # Where a process may lock little memory, as is usual, Zenoh would lose every map without a word.
        "transport/shared_memory/enabled": False,
    }
    file = settings.zenoh_config
    config = zenoh.Config.from_file(str(file)) if file else zenoh.Config()
    for key, value in asked.items():
        if value not in (None, []):
            config.insert_json5(key, json.dumps(value))
    return config
