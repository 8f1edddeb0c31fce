"""Depth frames of a recording, played at a steady rate: a depth folder, a ROS bag or an MCAP file."""

import time
from pathlib import Path

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_folder import DepthFolder
from cliffscan.services.capture.sources.depth_source import DepthFrame, SourceEnded
from cliffscan.services.capture.sources.recorded import Recorded


class Replay:
    """Plays a recording at `rate` [Hz], once or in a loop.

    Frames keep their recorded stamps, and a further round goes on from the last stamp of the one before. Those of a
    recording without stamps are stamped when they are played.
    """

    def __init__(self, recorded: Recorded, rate: float, loop: bool) -> None:
        self._recorded, self._loop, self._period = recorded, loop, 1.0 / rate
        self._images = recorded.images()
        self._next = next(self._images, None)
        self._due = time.monotonic()
        self._round = self._good = 0  # which it is; good frames of the first
        self._least, self._largest = 1 << 63, 0  # [ns] of the recorded stamps

    def read(self, timeout: float) -> DepthFrame | None:
        """The next frame when its time has come. Raises ConfigError where no image of a whole round is good."""
        if self._next is None:
            self._begin_again()
        wait = self._due - time.monotonic()
        time.sleep(min(max(wait, 0.0), timeout))
        image = self._next
        if wait > timeout or image is None:
            return None
        self._due = max(self._due + self._period, time.monotonic())
        self._next = next(self._images, None)
        frame = image.read()
        return frame._replace(stamp=self._stamp(frame.stamp))

    def close(self) -> None:
        """Close the recording."""
        self._recorded.close()

    def _begin_again(self) -> None:
        if not self._good:
            raise ConfigError("capture.path: no image in it can be used; `cliffscan check-data` says why")
        if not self._loop:
            raise SourceEnded
        self._round += 1
        self._images = self._recorded.images()
        self._next = next(self._images, None)

    def _stamp(self, recorded: int) -> int:
        """The stamp [ns] under which a frame is played."""
        if self._round == 0:
            self._good += 1
            self._least, self._largest = min(self._least, recorded), max(self._largest, recorded)
        if not self._recorded.stamped:
            return time.time_ns()
        length = self._largest - self._least
        step = length // (self._good - 1) if self._good > 1 else round(self._period * 1e9)
        return recorded + self._round * (length + step)


def open_recorded(config: CaptureConfig) -> Recorded:
    """The depth folder, bag or MCAP file that is configured. Raises ConfigError."""
    path = Path(config.path)
    if path.is_file() or (path / "metadata.yaml").is_file():
        from cliffscan.services.capture.ros.open_recording import open_recording  # a depth folder needs no rosbags

        return open_recording(path, config)
    return DepthFolder(path)


def open_configured(config: CaptureConfig) -> Replay:
    """The recording that is configured, played as configured. Raises ConfigError."""
    return Replay(open_recorded(config), config.rate, config.loop)
