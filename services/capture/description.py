"""What others need to know of the camera, published when a source is opened and when it changes."""

import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.description import CameraDescription, RobotDescription
from cliffscan.common.runtime.service import Service
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.kinds import KINDS

SOONEST = 1.0  # [s] between two descriptions of one stream: a recording may bring a floor with each frame


class Description:
    """The camera's part of the robot's description, kept for whoever asks later."""

    def __init__(self, service: Service[CaptureConfig]) -> None:
        self._publish = service.bus.latch(topics.DESCRIPTION)
        self._config, self._simulated = service.config, KINDS[service.config.source].simulated
        self._camera: Camera | None = None
        self._published = 0.0  # [s] when

    def begin(self, camera: Camera) -> None:
        """Describe the camera of a source's first frame, at its nominal mount, unless it is the last one's."""
        if camera == self._camera:
            return
        self._camera, self._published = camera, time.monotonic()
        described = CameraDescription.of(camera, self._config.frame, self._simulated, self._config.place())
        self._publish(RobotDescription(stamp=time.time_ns(), camera=described))

    def follow(self, camera: Camera) -> None:
        """Describe a later frame's camera if it is another one, but not sooner than SOONEST after the last."""
        if time.monotonic() - self._published >= SOONEST:
            self.begin(camera)
