"""The depth stream of a file that librealsense recorded: its own topics in a ROS 1 bag, or from 2.58 on in a `.db3`."""

import re
from bisect import bisect_right
from dataclasses import replace
from typing import Any

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.bag import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGES,
    TRANSFORMS,
    Bag,
    Sample,
    calibration,
    compressed,
    joint,
    picture,
    read_whole,
)
from cliffscan.services.capture.ros.calibration import Calibration
from cliffscan.services.capture.ros.pictures import CompressedPicture, Picture
from cliffscan.services.capture.ros.realsense_wire import (
    Shot,
    expanded,
    levels,
    number,
    shot,
    stream_calibration,
    without_unit,
)
from cliffscan.services.capture.ros.recorded_topic import RecordedTopic
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.realsense_sensor import millimetres, sensor_of
from cliffscan.services.capture.sources.recorded import Origins

VERSION, DEVICE = "/file_version", "/device_0/"
COUNT, NUMBER, TEXT = (f"std_msgs/msg/{name}" for name in ("UInt32", "Float32", "String"))  # TEXT: of a ROS 2 bag
DEPTH = re.compile(r"((/device_\d+/sensor_\d+)/Depth_\d+)/image/data(/compressedDepth)?")


def by_librealsense(bag: Bag) -> bool:
    """Whether librealsense wrote a recording."""
    return bool(bag.of(VERSION, COUNT)) and any(each.topic.startswith(DEVICE) for each in bag.connections)


class RealSenseRecording(RecordedTopic):
    """One depth stream. Raises ConfigError where it has none, or has no intrinsics.

    The unit of a depth is the frame's own, or else what the sensor's option was at that time.
    """

    def __init__(self, bag: Bag, config: CaptureConfig) -> None:
        images = (each.topic for each in bag.connections if each.msgtype in IMAGES)
        found = {topic: match for topic in images if (match := DEPTH.fullmatch(topic))}
        super().__init__(bag, config, f"{bag.kind} of librealsense", found)
        stream, sensor, _ = found[self._topic].groups()
        self._info = f"{stream}/info/camera_info" if bag.ros1 else f"{stream}/camera_info"
        self.camera.calibration = self._calibration()
        baselines = self._options(f"{sensor}/option/Stereo_Baseline/value")  # [mm]
        self._sees = sensor_of(self.camera.calibration.k[0], abs(baselines[0][1]) / 1000 if baselines else 0.0)
        self._unit_topic = f"{sensor}/option/Depth_Units/value"
        self._units = self._options(self._unit_topic)
        for message in bag.read("/tf_static", TRANSFORMS, self._decoded):
            self.camera.transforms.add(map(joint, message.transforms))
        self._shots = {} if bag.ros1 else dict(bag.read(f"{stream}/image/metadata", TEXT, self._shot))
        self._unit = 0.0  # [m] of the last frame that was read

    def origins(self) -> Origins:
        """What librealsense recorded, and what such a camera measures."""
        eyes = self._sees.baseline
        seen = f"that of two eyes {eyes:g} m apart" if eyes else "an L515's, for no Stereo_Baseline is recorded"
        return Origins(
            f"{self._unit * 1000:g} mm as recorded, which become millimetres",
            f"by {self._info}",
            "as configured" if self._config.range else seen,
            self.camera.mounted,
            "as configured" if self._config.noise else seen,
        )

    def _frame(self, sample: Sample | BadFrame) -> DepthFrame:
        sample = read_whole(sample)
        image, own = self._image(sample)
        self._unit = own or self._unit_at(sample.time)
        if not 0.0 < self._unit < 1.0:
            raise BadFrame(
                f"{self._topic}: the depth unit is not known, for neither the image nor {self._unit_topic} has it:"
                " record with a newer librealsense"
            )
        frame = self.camera.frame(image)
        reach, noise, baseline = self._sees
        camera = replace(frame.camera, range=reach, noise=noise, baseline=baseline)
        return frame._replace(depth=millimetres(frame.depth, self._unit), camera=camera)

    def _image(self, sample: Sample) -> tuple[Picture | CompressedPicture, float]:
        """An image of what the sensor sent, and its own depth unit [m]; 0 where it has none."""
        data, unit = without_unit(sample.data) if self._bag.ros1 else (sample.data, 0.0)
        message = self._decoded(sample._replace(data=data))
        packed = sample.connection.msgtype == COMPRESSED_IMAGE
        image = compressed(message) if packed else levels(picture(message))
        told = self._shots.get(sample.time)
        return (image._replace(stamp=told.stamp), told.unit) if told else (image, unit)

    def _unit_at(self, time: int) -> float:
        """The option's value [m] at a time [ns], 0 where it had none."""
        place = bisect_right(self._units, time, key=lambda each: each[0])
        return self._units[place - 1][1] if place else 0.0

    def _calibration(self) -> Calibration:
        def told(sample: Sample) -> Calibration:
            message = self._decoded(sample)
            return calibration(message) if self._bag.ros1 else stream_calibration(message.data)

        found = next(self._bag.read(self._info, CAMERA_INFO if self._bag.ros1 else TEXT, told), None)
        if found is None:
            raise ConfigError(f"capture.path {self._bag.path}: no intrinsics on {self._info}: record it again")
        return found

    def _options(self, topic: str) -> list[tuple[int, float]]:
        """The values of an option, each with the time [ns] from which on it had it."""
        kind = NUMBER if self._bag.ros1 else TEXT
        return list(self._bag.read(topic, kind, lambda sample: (sample.time, number(self._decoded(sample).data))))

    def _shot(self, sample: Sample) -> tuple[int, Shot]:
        return sample.time, shot(self._decoded(sample).data)

    def _decoded(self, sample: Sample) -> Any:  # noqa: ANN401
        return self._bag.decoded(sample._replace(data=expanded(sample.data)))
