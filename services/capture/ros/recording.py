"""The depth topic of a recording: a ROS 1 bag, a ROS 2 bag as folder or file, or an MCAP file with ROS messages."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.calibration import COMPRESSED, Calibration, info_topic
from cliffscan.services.capture.ros.camera import RosCamera
from cliffscan.services.capture.ros.mount import Joint
from cliffscan.services.capture.ros.pictures import ENCODINGS, CompressedPicture, Picture

SECOND = 1_000_000_000  # [ns]
IMAGE, COMPRESSED_IMAGE, INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/CameraInfo"


class Recording:
    """One depth topic of a recording. Raises ConfigError where it is none, or has no such topic or no CameraInfo."""

    def __init__(self, path: Path, config: CaptureConfig) -> None:
        self._path = path
        try:
            self._reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY))
            self._reader.open()
        except AnyReaderError as error:
            why = f"{error}: give a ROS bag, an MCAP file or a depth folder"
            raise ConfigError(f"capture.path {path}: {why}") from error
        self._connection = self._chosen(config.topic)
        self.camera = RosCamera(config, self._connection.topic)
        info = info_topic(self._connection.topic)
        found = next(self._of(topic=info), None)
        if found is None:
            raise ConfigError(f"capture.path {path}: no CameraInfo on {info}: record it beside the images")
        self.camera.calibration = _calibration(found)
        for message in self._of(topic="/tf_static"):
            self.camera.transforms.add(map(_joint, message.transforms))

    def pictures(self) -> Iterator[Picture | CompressedPicture]:
        """The depth images in order."""
        make = _compressed if self._connection.msgtype == COMPRESSED_IMAGE else _picture
        return (make(message) for message in self._of(connection=self._connection))

    def close(self) -> None:
        """Close the file."""
        self._reader.close()

    def _chosen(self, topic: str) -> Connection:
        depth = {each.topic: each for each in self._reader.connections if self._is_depth(each)}
        named = f"/{topic.lstrip('/')}" if topic else None
        if named in depth:
            return depth[named]
        if named or len(depth) != 1:
            asked = f"no depth topic {named}" if named else f"{len(depth)} depth topics"
            choice = f"set capture.topic to one of {', '.join(depth)}" if depth else "record an image topic of depths"
            raise ConfigError(f"capture.path {self._path}: {asked}: {choice}")
        return next(iter(depth.values()))

    def _is_depth(self, connection: Connection) -> bool:
        if connection.msgtype == COMPRESSED_IMAGE:
            return connection.topic.endswith(COMPRESSED)
        first = next(self._of(connection=connection), None) if connection.msgtype == IMAGE else None
        return first is not None and first.encoding in ENCODINGS

    def _of(self, topic: str = "", connection: Connection | None = None) -> Iterator[Any]:
        wanted = [connection] if connection else [each for each in self._reader.connections if each.topic == topic]
        if not wanted:  # rosbags would take none for all
            return
        for found, _, raw in self._reader.messages(wanted):
            yield self._reader.deserialize(raw, found.msgtype)


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
