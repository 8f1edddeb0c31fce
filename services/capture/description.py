"""What others need to know of the camera, published when a source is opened and when it changes."""

import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.description import CameraDescription, Place, RobotDescription
from cliffscan.common.runtime.service import Service
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import DepthFrame
from cliffscan.services.capture.sources.kinds import KINDS

SOONEST = 1.0  # [s] between two descriptions of one stream: a recording may bring a floor with each frame


class Description:
    """The camera's part of the robot's description, kept for whoever asks later."""

    def __init__(self, service: Service[CaptureConfig]) -> None:
        self._publish = service.bus.latch(topics.DESCRIPTION)
        self._config, self._simulated = service.config, KINDS[service.config.source].simulated
        self._described: tuple[Camera, Place] | None = None
        self._published = 0.0  # [s] when

    def begin(self, frame: DepthFrame) -> None:
        """Describe the camera of a source's first frame, at its nominal mount, unless it is the last one's."""
        camera, place = frame.camera, frame.place or self._config.place()
        if (camera, place) == self._described:
            return
        self._described, self._published = (camera, place), time.monotonic()
        described = CameraDescription.of(camera, self._config.frame, self._simulated, place)
        self._publish(RobotDescription(stamp=time.time_ns(), camera=described))

    def follow(self, frame: DepthFrame) -> None:
        """Describe a later frame's camera if it is another one, but not sooner than SOONEST after the last."""
        if time.monotonic() - self._published >= SOONEST:
            self.begin(frame)
