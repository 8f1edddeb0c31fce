"""The depth topic of a recording: a ROS 1 bag, a ROS 2 bag as folder or file, or an MCAP file with ROS messages."""

import logging
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.calibration import COMPRESSED, Calibration, info_topic
from cliffscan.services.capture.ros.camera import RosCamera
from cliffscan.services.capture.ros.mount import Joint
from cliffscan.services.capture.ros.pictures import ENCODINGS, CompressedPicture, Picture
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.recorded import Origins, RecordedImage

SECOND = 1_000_000_000  # [ns]
IMAGE, COMPRESSED_IMAGE = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
MEND = "mend one that was cut by `rosbag reindex`, `ros2 bag reindex` or `mcap recover`"

log = logging.getLogger(__name__)


class Sample(NamedTuple):
    """A message as it was recorded."""

    connection: Connection
    data: bytes


class Recording:
    """One depth topic of a recording. Raises ConfigError where it is none, or has no such topic or no CameraInfo."""

    stamped = True

    def __init__(self, path: Path, config: CaptureConfig) -> None:
        self._path, self._config = path, config
        self._reader = _opened(path)
        self.kind = "ROS 1 bag" if not self._reader.is2 else "MCAP file" if path.suffix == ".mcap" else "ROS 2 bag"
        self._topic = self._chosen(config.topic)
        self._connections = self._of(self._topic)
        self._encoding = ""
        self.camera = RosCamera(config, self._topic)
        info = info_topic(self._topic)
        found = next(self._messages(info), None)
        if found is None:
            raise ConfigError(f"capture.path {path}: no CameraInfo on {info}: record it beside the images")
        self.camera.calibration = _calibration(found)
        for message in self._messages("/tf_static"):
            self.camera.transforms.add(map(_joint, message.transforms))

    def __len__(self) -> int:
        return sum(each.msgcount for each in self._connections)

    def images(self) -> Iterator[RecordedImage]:
        """The images in the order in which they were recorded, by their number."""
        self.camera.restart()
        for number, sample in enumerate(self._samples(self._connections)):
            yield RecordedImage(f"{number:06}", partial(self._frame, sample))

    def contents(self) -> list[str]:
        """Its topics."""
        return [f"{name}: {info.msgcount} {info.msgtype}" for name, info in sorted(self._reader.topics.items())]

    def origins(self) -> Origins:
        """The messages, and what is configured."""
        units = "metres" if self._encoding.startswith("32FC1") else "millimetres"
        noise = "as configured" if self._config.noise else "a Kinect's, for ROS has none: set capture.noise"
        return Origins(
            f"{units}, for {self._topic} is {self._encoding or 'unread'} (REP-118)",
            f"by {info_topic(self._topic)}",
            "by capture.range, for ROS has none",
            self.camera.mounted,
            noise,
        )

    def close(self) -> None:
        """Close the file."""
        self._reader.close()

    def _frame(self, sample: Sample | BadFrame) -> DepthFrame:
        if isinstance(sample, BadFrame):
            raise sample
        message = self._decoded(sample)
        compressed = sample.connection.msgtype == COMPRESSED_IMAGE
        self._encoding = message.format if compressed else message.encoding
        return self.camera.frame(_compressed(message) if compressed else _picture(message))

    def _chosen(self, topic: str) -> str:
        depth = sorted({each.topic for each in self._reader.connections if self._is_depth(each)})
        named = f"/{topic.lstrip('/')}" if topic else None
        if named in depth:
            return named
        if named or len(depth) != 1:
            asked = f"no depth topic {named}" if named else f"{len(depth)} depth topics"
            choice = f"set capture.topic to one of {', '.join(depth)}" if depth else "record an image topic of depths"
            raise ConfigError(f"capture.path {self._path}: {asked}: {choice}")
        return depth[0]

    def _is_depth(self, connection: Connection) -> bool:
        if connection.msgtype == COMPRESSED_IMAGE:
            return connection.topic.endswith(COMPRESSED)
        first = next(self._messages(connection.topic), None) if connection.msgtype == IMAGE else None
        return first is not None and first.encoding in ENCODINGS

    def _of(self, topic: str) -> list[Connection]:
        return [each for each in self._reader.connections if each.topic == topic]

    def _messages(self, topic: str) -> Iterator[Any]:
        """The messages of a topic; one that cannot be read is passed over."""
        for sample in self._samples(self._of(topic)):
            try:
                yield self._decoded(sample)
            except BadFrame as error:
                log.warning("%s: passing over %s", topic, error)

    def _decoded(self, sample: Sample | BadFrame) -> Any:  # noqa: ANN401
        """Raises BadFrame."""
        if isinstance(sample, BadFrame):
            raise sample
        try:
            return self._reader.deserialize(sample.data, sample.connection.msgtype)
        except Exception as error:  # whatever bad bytes make numpy and struct raise
            raise BadFrame(
                f"a message that cannot be decoded ({_why(error)}): it was damaged after it was recorded"
            ) from error

    def _samples(self, connections: list[Connection]) -> Iterator[Sample | BadFrame]:
        """What was recorded, in order; a BadFrame at the end where the rest cannot be read."""
        if not connections:  # rosbags would take none for all
            return
        stream = self._reader.messages(connections)
        while True:
            try:
                connection, _, data = next(stream)
            except StopIteration:
                return
            except Exception as error:  # noqa: BLE001 - as there, or whatever a decompressor raises
                yield BadFrame(f"the rest of {self._path.name} cannot be read ({_why(error)}): {MEND}")
                return
            yield Sample(connection, data)


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


def _stamp(message: Any) -> int:  # noqa: ANN401
    return int(message.header.stamp.sec) * SECOND + int(message.header.stamp.nanosec)


def _picture(message: Any) -> Picture:  # noqa: ANN401
    size = message.height, message.width, message.encoding, bool(message.is_bigendian), message.step
    return Picture(_stamp(message), message.header.frame_id, *size, message.data)


def _compressed(message: Any) -> CompressedPicture:  # noqa: ANN401
    return CompressedPicture(_stamp(message), message.header.frame_id, message.format, message.data)


def _calibration(message: Any) -> Calibration:  # noqa: ANN401
    """Of ROS 1, too, which has capitals."""
    names = "dkp" if hasattr(message, "k") else "DKP"
    d, k, p = (tuple(map(float, getattr(message, name))) for name in names)
    return Calibration(message.height, message.width, d, k, p)


def _joint(message: Any) -> Joint:  # noqa: ANN401
    moved, turned = message.transform.translation, message.transform.rotation
    return Joint(
        message.header.frame_id,
        message.child_frame_id,
        (moved.x, moved.y, moved.z),
        (turned.x, turned.y, turned.z, turned.w),
    )
