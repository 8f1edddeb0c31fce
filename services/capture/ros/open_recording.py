"""A recording of messages, by whoever wrote it."""

from pathlib import Path

from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.bag import Bag
from cliffscan.services.capture.ros.realsense_recording import RealSenseRecording, by_librealsense
from cliffscan.services.capture.ros.recording import Recording
from cliffscan.services.capture.sources.recorded import Recorded


def open_recording(path: Path, config: CaptureConfig) -> Recorded:
    """The bag or MCAP file. Raises ConfigError."""
    bag = Bag(path)
    return (RealSenseRecording if by_librealsense(bag) else Recording)(bag, config)
