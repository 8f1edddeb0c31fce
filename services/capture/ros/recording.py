"""The depth topic of a recording, as ROS's drivers publish it."""

from rosbags.interfaces import Connection

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.bag import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    TRANSFORMS,
    Bag,
    Sample,
    calibration,
    compressed,
    joint,
    picture,
    read_whole,
)
from cliffscan.services.capture.ros.calibration import COMPRESSED, info_topic
from cliffscan.services.capture.ros.pictures import ENCODINGS
from cliffscan.services.capture.ros.recorded_topic import RecordedTopic
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.recorded import Origins


class Recording(RecordedTopic):
    """One depth topic of a recording. Raises ConfigError where it has no such topic or no CameraInfo."""

    def __init__(self, bag: Bag, config: CaptureConfig) -> None:
        super().__init__(bag, config, bag.kind, {each.topic for each in bag.connections if _is_depth(bag, each)})
        self._encoding = ""
        info = info_topic(self._topic)
        found = next(bag.messages(info, CAMERA_INFO), None)
        if found is None:
            raise ConfigError(f"capture.path {bag.path}: no CameraInfo on {info}: record it beside the images")
        self.camera.calibration = calibration(found)
        for message in bag.messages("/tf_static", TRANSFORMS):
            self.camera.transforms.add(map(joint, message.transforms))

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

    def _frame(self, sample: Sample | BadFrame) -> DepthFrame:
        sample = read_whole(sample)
        message = self._bag.decoded(sample)
        packed = sample.connection.msgtype == COMPRESSED_IMAGE
        self._encoding = message.format if packed else message.encoding
        return self.camera.frame(compressed(message) if packed else picture(message))


def _is_depth(bag: Bag, connection: Connection) -> bool:
    if connection.msgtype == COMPRESSED_IMAGE:
        return connection.topic.endswith(COMPRESSED)
    first = next(bag.messages(connection.topic, IMAGE), None) if connection.msgtype == IMAGE else None
    return first is not None and first.encoding in ENCODINGS
