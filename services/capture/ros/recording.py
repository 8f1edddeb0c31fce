"""The depth topic of a recording, as ROS's drivers publish it."""

from collections.abc import Iterator
from functools import partial

from rosbags.interfaces import Connection

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.bag import (
    COMPRESSED_IMAGE,
    IMAGE,
    Bag,
    Sample,
    calibration,
    compressed,
    joint,
    picture,
    read_whole,
)
from cliffscan.services.capture.ros.calibration import COMPRESSED, info_topic
from cliffscan.services.capture.ros.camera import RosCamera
from cliffscan.services.capture.ros.pictures import ENCODINGS
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.recorded import Origins, RecordedImage


class Recording:
    """One depth topic of a recording. Raises ConfigError where it has no such topic or no CameraInfo."""

    stamped = True

    def __init__(self, bag: Bag, config: CaptureConfig) -> None:
        self._bag, self._config = bag, config
        self.kind, self.contents = bag.kind, bag.contents
        depth = sorted({each.topic for each in bag.connections if self._is_depth(each)})
        self._topic = bag.depth_topic(config.topic, depth)
        self._connections = bag.of(self._topic)
        self._encoding = ""
        self.camera = RosCamera(config, self._topic)
        info = info_topic(self._topic)
        found = next(bag.messages(info), None)
        if found is None:
            raise ConfigError(f"capture.path {bag.path}: no CameraInfo on {info}: record it beside the images")
        self.camera.calibration = calibration(found)
        for message in bag.messages("/tf_static"):
            self.camera.transforms.add(map(joint, message.transforms))

    def __len__(self) -> int:
        return sum(each.msgcount for each in self._connections)

    def images(self) -> Iterator[RecordedImage]:
        """The images in the order in which they were recorded, by their number."""
        self.camera.restart()
        for number, sample in enumerate(self._bag.samples(self._connections)):
            yield RecordedImage(f"{number:06}", partial(self._frame, sample))

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
        self._bag.close()

    def _frame(self, sample: Sample | BadFrame) -> DepthFrame:
        sample = read_whole(sample)
        message = self._bag.decoded(sample)
        packed = sample.connection.msgtype == COMPRESSED_IMAGE
        self._encoding = message.format if packed else message.encoding
        return self.camera.frame(compressed(message) if packed else picture(message))

    def _is_depth(self, connection: Connection) -> bool:
        if connection.msgtype == COMPRESSED_IMAGE:
            return connection.topic.endswith(COMPRESSED)
        first = next(self._bag.messages(connection.topic), None) if connection.msgtype == IMAGE else None
        return first is not None and first.encoding in ENCODINGS
