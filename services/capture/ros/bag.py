"""The messages of a recording: a ROS 1 bag, a ROS 2 bag as folder or file, or an MCAP file with ROS messages."""

import logging
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.ros.calibration import Calibration
from cliffscan.services.capture.ros.mount import Joint
from cliffscan.services.capture.ros.pictures import CompressedPicture, Picture
from cliffscan.services.capture.sources.depth_source import BadFrame

IMAGE, COMPRESSED_IMAGE = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
IMAGES = (IMAGE, COMPRESSED_IMAGE)
CAMERA_INFO, TRANSFORMS = "sensor_msgs/msg/CameraInfo", "tf2_msgs/msg/TFMessage"
SECOND = 1_000_000_000  # [ns]
MEND = "mend one that was cut by `rosbag reindex`, `ros2 bag reindex` or `mcap recover`"
DAMAGED = "it was damaged after it was recorded"

T = TypeVar("T")

log = logging.getLogger(__name__)


class Sample(NamedTuple):
    """A message as it was recorded, at `time` [ns]."""

    connection: Connection
    time: int
    data: bytes


class Bag:
    """A recording that is open. kind: what it is, in words; ros1: whether its messages are ROS 1's.

    Raises ConfigError where it is none.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._reader = _opened(path)
        self.ros1 = not self._reader.is2
        self.kind = "ROS 1 bag" if self.ros1 else "MCAP file" if path.suffix == ".mcap" else "ROS 2 bag"

    @property
    def connections(self) -> Sequence[Connection]:
        """What was recorded: each topic with its type, perhaps several times."""
        return self._reader.connections

    def of(self, topic: str, *types: str) -> list[Connection]:
        """The connections of a topic that have one of these types: anybody may have published others there."""
        return [each for each in self.connections if each.topic == topic and each.msgtype in types]

    def contents(self) -> list[str]:
        """The topics, a line each."""
        return [f"{name}: {info.msgcount} {info.msgtype}" for name, info in sorted(self._reader.topics.items())]

    def depth_topic(self, named: str, depth: Sequence[str]) -> str:
        """The topic of `depth` that is named, or the only one. Raises ConfigError."""
        topic = f"/{named.lstrip('/')}"
        if topic in depth:
            return topic
        if named or len(depth) != 1:
            asked = f"no depth topic {topic}" if named else f"{len(depth)} depth topics"
            choice = f"set capture.topic to one of {', '.join(depth)}" if depth else "record an image topic of depths"
            raise ConfigError(f"capture.path {self.path}: {asked}: {choice}")
        return depth[0]

    def samples(self, connections: list[Connection]) -> Iterator[Sample | BadFrame]:
        """What was recorded, in order; a BadFrame at the end where the rest cannot be read."""
        if not connections:  # rosbags would take none for all
            return
        stream = self._reader.messages(connections)
        while True:
            try:
                connection, time, data = next(stream)
            except StopIteration:
                return
            except Exception as error:  # noqa: BLE001 - as in decoded(), or whatever a decompressor raises
                yield BadFrame(f"the rest of {self.path.name} cannot be read ({_why(error)}): {MEND}")
                return
            yield Sample(connection, time, data)

    def decoded(self, sample: Sample) -> Any:  # noqa: ANN401
        """The message. Raises BadFrame."""
        try:
            return self._reader.deserialize(sample.data, sample.connection.msgtype)
        except Exception as error:  # whatever bad bytes make numpy and struct raise
            raise BadFrame(f"a message that cannot be decoded ({_why(error)}): {DAMAGED}") from error

    def messages(self, topic: str, kind: str) -> Iterator[Any]:
        """The messages of a topic that have this type; one that cannot be read is passed over."""
        return self.read(topic, kind, self.decoded)

    def read(self, topic: str, kind: str, decode: Callable[[Sample], T]) -> Iterator[T]:
        """What `decode` makes of such messages; one of which it makes a BadFrame is passed over."""
        for sample in self.samples(self.of(topic, kind)):
            try:
                yield decode(read_whole(sample))
            except BadFrame as error:
                log.warning("%s: passing over %s", topic, error)

    def close(self) -> None:
        """Close the file."""
        self._reader.close()


def read_whole(sample: Sample | BadFrame) -> Sample:
    """A sample that was read. Raises the BadFrame that came instead."""
    if isinstance(sample, BadFrame):
        raise sample
    return sample


def _opened(path: Path) -> AnyReader:
    """A reader of the recording. Raises ConfigError."""
    try:
        reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY))
        reader.open()
    except Exception as error:  # rosbags lets through whatever bad bytes make its parsers raise
        why = f"{_why(error)}: give a ROS bag, an MCAP file or a depth folder; {MEND}"
        raise ConfigError(f"capture.path {path}: {why}") from error
    return reader


def _why(error: Exception) -> str:
    """One line, without a full stop."""
    return " ".join(f"{error}".split()).rstrip(".") or type(error).__name__


def stamp(message: Any) -> int:  # noqa: ANN401
    """A header's time [ns]."""
    return int(message.header.stamp.sec) * SECOND + int(message.header.stamp.nanosec)


def picture(message: Any) -> Picture:  # noqa: ANN401
    """Of a sensor_msgs/Image."""
    size = message.height, message.width, message.encoding, bool(message.is_bigendian), message.step
    return Picture(stamp(message), message.header.frame_id, *size, message.data)


def compressed(message: Any) -> CompressedPicture:  # noqa: ANN401
    """Of a sensor_msgs/CompressedImage."""
    return CompressedPicture(stamp(message), message.header.frame_id, message.format, message.data)


def calibration(message: Any) -> Calibration:  # noqa: ANN401
    """Of a sensor_msgs/CameraInfo; of ROS 1, too, which has capitals."""
    names = "dkp" if hasattr(message, "k") else "DKP"
    d, k, p = (tuple(map(float, getattr(message, name))) for name in names)
    return Calibration(message.height, message.width, d, k, p)


def joint(message: Any) -> Joint:  # noqa: ANN401
    """Of a geometry_msgs/TransformStamped."""
    moved, turned = message.transform.translation, message.transform.rotation
    return Joint(
        message.header.frame_id,
        message.child_frame_id,
        (moved.x, moved.y, moved.z),
        (turned.x, turned.y, turned.z, turned.w),
    )
