"""The messages of a live ROS 2 camera, of their CDR. All functions raise CdrError."""

import numpy as np

from cliffscan.services.capture.ros.calibration import Calibration
from cliffscan.services.capture.ros.mount import Joint
from cliffscan.services.capture.ros.pictures import CompressedPicture, Picture
from cliffscan.services.ros2.cdr import Reader


def picture(reader: Reader) -> Picture:
    """A sensor_msgs/Image."""
    stamp, frame = reader.header()
    height, width = reader.numbers("I", 2)
    encoding = reader.text()
    (big_endian,) = reader.numbers("B", 1)
    (step,) = reader.numbers("I", 1)
    return Picture(stamp, frame, height, width, encoding, bool(big_endian), step, reader.sequence(np.uint8))


def compressed_picture(reader: Reader) -> CompressedPicture:
    """A sensor_msgs/CompressedImage."""
    stamp, frame = reader.header()
    return CompressedPicture(stamp, frame, reader.text(), reader.sequence(np.uint8))


def calibration(reader: Reader) -> Calibration:
    """A sensor_msgs/CameraInfo, without its rectification, binning and region."""
    reader.header()
    height, width = reader.numbers("I", 2)
    reader.text()
    distortion = tuple(reader.sequence(np.float64).tolist())
    k = reader.numbers("d", 9)
    reader.numbers("d", 9)
    return Calibration(height, width, distortion, k, reader.numbers("d", 12))


def joints(reader: Reader) -> list[Joint]:
    """A tf2_msgs/TFMessage."""
    (count,) = reader.numbers("I", 1)
    return [_joint(reader) for _ in range(count)]


def _joint(reader: Reader) -> Joint:
    _stamp, parent = reader.header()
    child = reader.text()
    numbers = reader.numbers("d", 7)
    return Joint(parent, child, numbers[:3], numbers[3:])
