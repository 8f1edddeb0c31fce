"""Frames of a ROS depth camera: each picture with the intrinsics, the mount and the period that it has."""

import logging

from cliffscan.common.contract.camera import Camera, check_camera
from cliffscan.common.contract.description import Place
from cliffscan.common.contract.limits import LONGEST_PERIOD
from cliffscan.services.capture.config import KINECT_RANGE, CaptureConfig
from cliffscan.services.capture.ros.calibration import Calibration, info_topic
from cliffscan.services.capture.ros.mount import BASES, Mount, StaticTransforms
from cliffscan.services.capture.ros.pictures import CompressedPicture, Picture
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame

SET_BACK = 1_000_000_000  # [ns] by which an older stamp means that the clock was set or a recording begun anew

log = logging.getLogger(__name__)


class RosCamera:
    """Makes frames of the pictures of one topic. calibration, transforms: what is known of the camera by now."""

    def __init__(self, config: CaptureConfig, topic: str) -> None:
        self._config, self._topic = config, topic
        self.calibration: Calibration | None = None
        self.transforms = StaticTransforms()
        self.mounted = ""  # where the last frame's mount comes from, in words
        self._stamp: int | None = None
        self._told = ""

    def restart(self) -> None:
        """Pictures begin anew, as those of a recording do."""
        self._stamp = None

    def complete(self, frame: str) -> bool:
        """Whether all that may be known of pictures of a frame is known."""
        try:
            return self.calibration is not None and self.transforms.mount(frame) is not None
        except ValueError:  # it will not be known; frame() says why
            return True

    def frame(self, picture: Picture | CompressedPicture) -> DepthFrame:
        """A picture's frame. Raises BadFrame."""
        period = self._period(picture.stamp)
        try:
            camera, place = self._camera(picture.frame)
            depth = picture.millimetres(camera.width, camera.height)
        except BadFrame as error:
            raise BadFrame(f"{self._topic}: {error}") from error
        return DepthFrame(depth, picture.stamp, camera, period, place)

    def _mount(self, frame: str) -> Mount:
        """The mount by the static transforms, or else the configured one. Raises BadFrame."""
        try:
            found = self.transforms.mount(frame)
        except ValueError as error:
            raise BadFrame(f"{error}: correct /tf_static") from error
        mount = found or Mount(self._config.mounted_floor(), self._config.place())
        self.mounted = (
            f"by /tf_static of {frame!r}"
            if found
            else f"as configured, for no static transform leads from {' or '.join(BASES)} to {frame!r}"
        )
        height, pitch, roll = mount.floor.mount()
        told = f"the mount {self.mounted}: {height:.3f} m high, {pitch:.3f} rad down, rolled {roll:.3f} rad"
        if told != self._told:
            self._told = told
            log.info("%s", told)
        return mount

    def _camera(self, frame: str) -> tuple[Camera, Place]:
        if self.calibration is None:
            raise BadFrame(f"no CameraInfo on {info_topic(self._topic)}: have the driver publish it beside the image")
        width, height = self.calibration.width, self.calibration.height
        floor, place = self._mount(frame)
        camera = Camera(width, height, self.calibration.intrinsics(self._topic), KINECT_RANGE, floor)
        try:
            check_camera(camera)
        except ValueError as error:
            raise BadFrame(f"{error}: correct CameraInfo or /tf_static") from error
        return camera, place

    def _period(self, stamp: int) -> float | None:
        """The time [s] since the last frame, as much as a message can tell; None of the first.

        Raises BadFrame for a frame that is not later than the last. A frame may come twice: `ros2` publishes what
        capture publishes, and under the same topic.
        """
        if stamp <= 0:
            raise BadFrame(f"{self._topic}: the image has no stamp: have the driver set it")
        last = self._stamp
        if last is not None and last - SET_BACK < stamp <= last:
            raise BadFrame(f"{self._topic}: stamp {stamp} is not later than the last, {last}: do two publish it?")
        self._stamp = stamp
        return None if last is None or stamp < last else min((stamp - last) * 1e-9, LONGEST_PERIOD)
