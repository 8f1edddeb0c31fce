"""Depth frames from a recording of ROS messages."""

import time
from pathlib import Path

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.recording import Recording
from cliffscan.services.capture.sources.depth_source import DepthFrame, SourceEnded


class BagReplay:
    """Plays the depth topic of a recording at `rate` [Hz], once or in a loop, with the recorded stamps.

    A further round goes on from the last stamp of the one before. Raises ConfigError where the recording is unusable.
    """

    def __init__(self, path: Path, config: CaptureConfig) -> None:
        self._recording = Recording(path, config)
        self._pictures = self._recording.pictures()
        self._loop, self._period = config.loop, 1.0 / config.rate
        self._due = time.monotonic()
        self._first: int | None = None  # [ns] stamp of the recording
        self._last = self._shift = 0  # [ns] stamp that was played; of this round

    def read(self, timeout: float) -> DepthFrame | None:
        """The next frame when its time has come."""
        wait = self._due - time.monotonic()
        time.sleep(min(max(wait, 0.0), timeout))
        if wait > timeout:
            return None
        self._due = max(self._due + self._period, time.monotonic())
        picture = next(self._pictures, None)
        if picture is None:
            self._begin_again()
            return None
        if self._first is None:
            self._first = picture.stamp
        self._last = picture.stamp + self._shift
        return self._recording.camera.frame(picture._replace(stamp=self._last))

    def close(self) -> None:
        """Close the recording."""
        self._recording.close()

    def _begin_again(self) -> None:
        if not self._loop:
            raise SourceEnded
        if self._first is None:
            raise ConfigError("capture.path: the depth topic holds no image")
        self._shift = self._last + round(self._period * 1e9) - self._first
        self._pictures = self._recording.pictures()
