"""Depth frames of any ROS 2 driver over rmw_zenoh: an image topic, its CameraInfo, and /tf_static for the mount."""

import threading
import time
from collections.abc import Callable, Iterable

from cliffscan.common.contract.limits import MOST_PIXELS, SMALL
from cliffscan.common.runtime.service import Service
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros import wire
from cliffscan.services.capture.ros.calibration import COMPRESSED, Calibration, info_topic
from cliffscan.services.capture.ros.camera import RosCamera
from cliffscan.services.capture.ros.mount import Joint
from cliffscan.services.capture.ros.pictures import CompressedPicture, Picture
from cliffscan.services.capture.sources.depth_source import DepthFrame, SourceLost
from cliffscan.services.ros2 import interfaces
from cliffscan.services.ros2.cdr import Reader
from cliffscan.services.ros2.node import Node, Profile

NODE = "cliffscan_capture"
TOPIC = "/camera/depth/image_rect_raw"
NEWEST = 1  # images that may wait
LARGEST = 4 * MOST_PIXELS + SMALL  # [bytes] of an image
SILENCE = 3.0  # [s] without an image until the driver counts as lost
GRACE = 1.0  # [s] in which CameraInfo and static transforms may come after the first image


class Ros2Depth:
    """The images of one topic, a queue of one: an image that nobody has read gives way to the next."""

    def __init__(self, config: CaptureConfig, service: Service[CaptureConfig]) -> None:
        self._topic = "/" + (config.topic or TOPIC).lstrip("/")
        self._domain = config.domain
        self._camera = RosCamera(config, self._topic)
        self._changed = threading.Condition()  # guards what the session's threads bring, the next three
        self._newest: Picture | CompressedPicture | None = None
        self._calibration: Calibration | None = None
        self._joints: list[Joint] = []
        self._opened_at = self._received_at = time.monotonic()
        self._keys = service.bus.ros_keys(config.domain)
        node = Node(self._keys, service.metrics, NODE, "", config.domain)
        info, transforms = info_topic(self._topic).strip("/"), interfaces.TF_MESSAGE
        node.subscribe("tf_static", transforms, lambda each: self._placed(wire.joints(each)), Profile.LATCHED)
        node.subscribe(
            info, interfaces.CAMERA_INFO, lambda each: self._calibrated(wire.calibration(each)), Profile.SENSOR_DATA
        )
        image, read = self._images()
        node.subscribe(
            self._topic.strip("/"), image, lambda each: self._arrived(read(each)), Profile.SENSOR_DATA, NEWEST, LARGEST
        )
        node.announce()

    def read(self, timeout: float) -> DepthFrame | None:
        """The newest frame not yet read, or None if none came within `timeout` [s].

        Raises BadFrame for an image that is no depth of this camera, SourceLost where none came for SILENCE.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._newest, timeout)
            newest, self._newest = self._newest, None
            self._camera.calibration = self._calibration
            joints, self._joints = self._joints, []
            silence = time.monotonic() - self._received_at
        self._camera.transforms.add(joints)
        if newest:
            early = time.monotonic() - self._opened_at < GRACE
            return None if early and not self._camera.complete(newest.frame) else self._camera.frame(newest)
        if silence >= SILENCE:
            raise SourceLost(
                f"no image on {self._topic} in domain {self._domain} for {silence:.1f} s: start the camera's driver"
                " with RMW_IMPLEMENTATION=rmw_zenoh_cpp at this router, or name its topic by capture.topic"
            )
        return None

    def close(self) -> None:
        """Leave the graph."""
        self._keys.retract()

    def _images(self) -> tuple[interfaces.Interface, Callable[[Reader], Picture | CompressedPicture]]:
        if self._topic.endswith(COMPRESSED):
            return interfaces.COMPRESSED_IMAGE, wire.compressed_picture
        return interfaces.IMAGE, wire.picture

    def _arrived(self, picture: Picture | CompressedPicture) -> None:
        with self._changed:
            self._newest, self._received_at = picture, time.monotonic()
            self._changed.notify()

    def _calibrated(self, calibration: Calibration) -> None:
        with self._changed:
            self._calibration = calibration

    def _placed(self, joints: Iterable[Joint]) -> None:
        with self._changed:
            self._joints.extend(joints)


def open_configured(config: CaptureConfig, service: Service[CaptureConfig]) -> Ros2Depth:
    """The depth topic that is configured."""
    return Ros2Depth(config, service)
