"""Intel RealSense depth cameras (D400, D500) through librealsense.

librealsense serves USB in threads of its own. Its calls that open and close a camera may take seconds.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial

import numpy as np
import pyrealsense2 as rs

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import DepthFrame, SourceLost
from cliffscan.services.capture.sources.device_thread import TURN, DeviceThread
from cliffscan.services.capture.sources.modes import best_mode
from cliffscan.services.capture.sources.realsense_sensor import millimetres, sensor_of

REPLUG = "replug it into a USB 3 port"
RULES = "install udev/60-realsense.rules"


def open_configured(config: CaptureConfig) -> DeviceThread[DepthFrame]:
    """The camera with the configured serial number, or the first. Raises SourceLost, ConfigError."""
    name = f"RealSense {config.serial}".rstrip()
    return DeviceThread(name, REPLUG, partial(RealSenseStream, name, config))


def connected() -> list[rs.device]:
    """The cameras that librealsense finds."""
    return list(rs.context().query_devices())


class RealSenseStream:
    """librealsense's calls in order: opened and started by the constructor, served, closed; all in one thread.

    arrived: called within serve() with each frame. Its stamp is that of the exposure, which librealsense converts to
    the host's clock, or where it cannot, the host's clock when the frame had come in.
    Raises SourceLost, naming the remedy, when the camera cannot be opened or is gone; ConfigError for a size that it
    does not have.
    """

    def __init__(self, name: str, config: CaptureConfig, arrived: Callable[[DepthFrame], None]) -> None:
        self._name, self._arrived = name, arrived
        self._frames = rs.frame_queue(1)
        with ExitStack() as release, self._failing("does not open"):
            self._device = self._find(config.serial)
            sensor = self._device.first_depth_sensor()
            profile = self._profile(sensor, config)
            self._period = 1.0 / profile.fps()
            self._camera = self._describe(sensor, profile.get_intrinsics(), config.mounted_floor())
            sensor.open(profile)
            release.callback(sensor.close)
            sensor.start(self._frames)
            release.callback(sensor.stop)
            self._release = release.pop_all()

    def serve(self) -> None:
        """Wait for a frame, for at most TURN, and pass it on."""
        with self._failing("is gone"):
            came, frame = self._frames.try_wait_for_frame(round(TURN * 1e3))
            if came:
                self._arrived(self._depth_frame(frame))
            elif not self._device.is_connected():
                raise SourceLost(f"{self._name} is gone: {REPLUG}")

    def close(self) -> None:
        """Stop the stream and close the camera."""
        with suppress(RuntimeError):  # one that is gone can be stopped no more
            self._release.close()

    @contextmanager
    def _failing(self, what: str) -> Iterator[None]:
        try:
            yield
        except RuntimeError as error:
            raise SourceLost(f"{self._name} {what} ({error}): {remedy(str(error))}") from error

    def _find(self, serial: str) -> rs.device:
        """The first camera, or the one with the serial number."""
        found = {device.get_info(rs.camera_info.serial_number): device for device in connected()}
        for number, device in found.items():
            if serial in ("", number):
                return device
        others = ", ".join(found) or "none"
        raise SourceLost(
            f"no {self._name} (found: {others}): plug it into a USB 3 port; if lsusb lists it, {RULES} and replug it"
        )

    def _profile(self, sensor: rs.sensor, config: CaptureConfig) -> rs.video_stream_profile:
        profiles = [each.as_video_stream_profile() for each in sensor.get_stream_profiles() if is_depth(each)]
        modes = [(each.width(), each.height(), each.fps()) for each in profiles]
        return profiles[best_mode(modes, config.size, self._name)]

    def _describe(self, sensor: rs.sensor, told: rs.intrinsics, floor: FloorPlane) -> Camera:
        """The camera by its own calibration."""
        if any(told.coeffs):
            raise ConfigError(
                f"{self._name} has a distorted depth image, {told}: take a rectified topic of its ROS driver by"
                " capture.source=ros2"
            )
        option = rs.option.stereo_baseline
        baseline = abs(sensor.get_option(option)) / 1000 if sensor.supports(option) else 0.0
        sees = sensor_of(told.fx, baseline)
        intrinsics = Intrinsics(told.fx, told.fy, told.ppx, told.ppy)
        return Camera(told.width, told.height, intrinsics, sees.range, floor, sees.noise, sees.baseline)

    def _depth_frame(self, frame: rs.frame) -> DepthFrame:
        depth = millimetres(np.asanyarray(frame.get_data()), frame.as_depth_frame().get_units())
        return DepthFrame(depth, stamp(frame), self._camera, self._period)


def is_depth(profile: rs.stream_profile) -> bool:
    """Whether a stream has depths of 16 bits."""
    return bool(profile.stream_type() == rs.stream.depth and profile.format() == rs.format.z16)


def stamp(frame: rs.frame) -> int:
    """The time of capture [ns since the epoch]."""
    if frame.get_frame_timestamp_domain() == rs.timestamp_domain.hardware_clock:
        return time.time_ns()
    milliseconds: float = frame.get_timestamp()
    return round(milliseconds * 1e6)


def remedy(reason: str) -> str:
    """What to do about librealsense's error."""
    if "ACCESS" in reason or "ermission" in reason:
        return f"{RULES}, join the group plugdev, and replug it"
    if "busy" in reason.lower():
        return "another program has it"
    return REPLUG
