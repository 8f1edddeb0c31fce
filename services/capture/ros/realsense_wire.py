"""What librealsense writes where it departs from ROS's messages. All functions raise BadFrame.

Sources: librealsense's ros_writer.cpp, sensor_msgs/Image.h, ros2_writer.cpp, and files that 2.55 to 2.59 wrote.
"""

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import zstandard

from cliffscan.services.capture.ros.bag import DAMAGED
from cliffscan.services.capture.ros.calibration import Calibration
from cliffscan.services.capture.ros.pictures import Picture
from cliffscan.services.capture.sources.depth_source import BadFrame

Z16 = "mono16"  # what its images of depths have for an encoding
ZSTD = b"\x28\xb5\x2f\xfd"  # begins what zstandard compressed
LARGEST_MESSAGE = 64 << 20  # [bytes] to which a compressed one may grow
FRAME = slice(12, 17)  # of an image of ROS 1: the header's frame, with its length, after its number and its stamp
WITH_UNIT = b"\x01\x00\x00\x001"  # the frame "1", which says that the depth unit follows the image
UNIT = struct.Struct("<f")
OPTICAL = "Depth"  # the frame of its images in a ROS 2 bag


class Shot(NamedTuple):
    """What the metadata of a frame have: its stamp [ns], and its depth unit [m], 0 where they have none."""

    stamp: int
    unit: float


def without_unit(data: bytes) -> tuple[bytes, float]:
    """An image of ROS 1 alone, and the depth unit [m] that followed it; 0 where none does, as in old files."""
    if data[FRAME] != WITH_UNIT:
        return data, 0.0
    return data[: -UNIT.size], UNIT.unpack(data[-UNIT.size :])[0]


def expanded(data: bytes) -> bytes:
    """A message, which librealsense 2.58 compressed by itself."""
    if not data.startswith(ZSTD):
        return data
    with damage():
        if zstandard.frame_content_size(data) > LARGEST_MESSAGE:
            raise ValueError(f"it would grow to more than {LARGEST_MESSAGE} bytes")
        return zstandard.ZstdDecompressor().decompress(data)


def levels(image: Picture) -> Picture:
    """An image of depths in the sensor's unit, as ROS has it otherwise."""
    if image.encoding != Z16:
        raise BadFrame(f"encoding {image.encoding!r}, expected {Z16}: record the depth stream as Z16")
    return image._replace(frame=OPTICAL, encoding="16UC1")


def shot(text: str) -> Shot:
    """The metadata of a frame, as timestamp=1700000000000.0;depth_units=0.00025."""
    with damage():
        told = fields(text)
        return Shot(round(float(told["timestamp"]) * 1e6), float(told.get("depth_units", 0.0)))


def stream_calibration(text: str) -> Calibration:
    """The intrinsics of a stream, as width=640;height=480;fx=460;fy=460;ppx=320;ppy=240;coeffs=0,0,0,0,0."""
    with damage():
        told = fields(text)
        fx, fy, cx, cy = (float(told[name]) for name in ("fx", "fy", "ppx", "ppy"))
        k = (fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0)
        distortion = tuple(map(float, told["coeffs"].split(",")))
        return Calibration(int(told["height"]), int(told["width"]), distortion, k, (0.0,) * 12)


def number(value: float | str) -> float:
    """The value of an option, which is a text in a ROS 2 bag."""
    with damage():
        return float(value)


def fields(text: str) -> dict[str, str]:
    """The values by their names."""
    pairs = (pair.partition("=") for pair in text.split(";"))
    return {name: value for name, _, value in pairs}


@contextmanager
def damage() -> Iterator[None]:
    """Turns what bad bytes raise into BadFrame."""
    try:
        yield
    except (KeyError, ValueError, OverflowError, zstandard.ZstdError) as error:
        raise BadFrame(f"a message that cannot be decoded ({type(error).__name__}: {error}): {DAMAGED}") from error
