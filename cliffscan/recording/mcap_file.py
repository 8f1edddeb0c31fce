"""One MCAP file of ROS messages, which loses no more than its last second where its writer is killed."""

import os
from pathlib import Path
from typing import NamedTuple, Self

from mcap.writer import CompressionType, Writer

from cliffscan.common.runtime.service import package_version
from cliffscan.recording.definitions import schema
from cliffscan.services.ros2.interfaces import Interface
from cliffscan.services.ros2.node import Profile

METADATA = "cliffscan"  # name of the record that says whose recording it is
CHUNK = 8 << 20  # [bytes] after which a chunk is written before its time has come
COMPRESSION = CompressionType.LZ4  # a quarter of zstandard's time for a tenth more bytes: frames are compressed already


class RosTopic(NamedTuple):
    """A topic of the file."""

    name: str  # with its leading slash
    interface: Interface
    profile: Profile


class McapFile:
    """Writes messages; a context manager, which leaves a whole file behind."""

    def __init__(self, path: Path, robot: str) -> None:
        """Raises FileExistsError rather than overwrite a file, and OSError where none can be made."""
        self.path = path
        self._file = path.open("xb")
        self._writer = Writer(self._file, CHUNK, COMPRESSION)
        self._writer.start("ros2", f"cliffscan {package_version()}")
        self._writer.add_metadata(METADATA, {"robot": robot})
        self._channels: dict[RosTopic, int] = {}
        self._schemas: dict[Interface, int] = {}
        self.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with self._file:
            self._writer.finish()

    @property
    def size(self) -> int:
        """What is on the disk [bytes]."""
        return self.path.stat().st_size

    def add(self, topic: RosTopic, stamp: int, payload: bytes) -> None:
        """Add a message that came at `stamp` [ns]; it is in the file after the next flush()."""
        self._writer.add_message(self._channel(topic), stamp, payload, stamp)

    def flush(self) -> None:
        """Bring what was added to the disk, as a chunk of its own."""
        self._writer.flush()
        os.fdatasync(self._file.fileno())

    def _channel(self, topic: RosTopic) -> int:
        channel = self._channels.get(topic)
        if channel is None:
            interface = topic.interface
            metadata = {"offered_qos_profiles": offered_qos(topic.profile), "topic_type_hash": interface.type_hash}
            channel = self._writer.register_channel(topic.name, "cdr", self._schema(interface), metadata)
            self._channels[topic] = channel
        return channel

    def _schema(self, interface: Interface) -> int:
        if interface not in self._schemas:
            text = schema(interface.message_name).encode()
            self._schemas[interface] = self._writer.register_schema(interface.message_name, "ros2msg", text)
        return self._schemas[interface]


def offered_qos(profile: Profile) -> str:
    """A quality of service as rosbag2 wants it, in numbers as rmw has them."""
    reliability, durability, history, *_ = profile.value.split(":")
    kind, depth = history.split(",")
    numbers = {"history": kind, "depth": depth, "reliability": reliability, "durability": durability}
    lines = [f"{name}: {number}" for name, number in numbers.items()]
    for name in ("deadline", "lifespan", "liveliness_lease_duration"):
        lines += [f"{name}:", "  sec: 0", "  nsec: 0"]
    return "- " + "\n  ".join((*lines, "liveliness: 1", "avoid_ros_namespace_conventions: false"))
