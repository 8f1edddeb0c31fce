"""A depth image of ROS as millimetres.

Sources: REP-118 for sensor_msgs/Image, compressed_depth_image_transport's codec for sensor_msgs/CompressedImage.
"""

import struct
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.services.capture.sources.depth_png import decode_depth
from cliffscan.services.capture.sources.depth_source import BadFrame

Bytes = NDArray[np.uint8]
Depth = NDArray[np.uint16]

LARGEST = float(np.iinfo(np.uint16).max)  # [mm]
PNG = b"\x89PNG"
QUANTISER = struct.Struct("<iff")  # what it is, and the a and b of an inverse depth, before a compressed picture


class Picture(NamedTuple):
    """A sensor_msgs/Image. stamp [ns]; step [bytes] from one row to the next; data: (bytes,)."""

    stamp: int
    frame: str
    height: int
    width: int
    encoding: str
    big_endian: bool
    step: int
    data: Bytes

    def millimetres(self, width: int, height: int) -> Depth:
        """(height, width) [mm], 0 = no return. Raises BadFrame for an image of another size or one that lies."""
        kind, convert = conversion(self.encoding)
        if (self.width, self.height) != (width, height):
            raise BadFrame(
                f"the image has {self.width}x{self.height} pixels, its CameraInfo {width}x{height}:"
                " both must be of one driver and one profile"
            )
        if self.big_endian:
            raise BadFrame("the image is big-endian, expected is_bigendian = 0: set its driver so")
        least = width * kind.itemsize
        if self.step < least:
            raise BadFrame(f"step {self.step} for {width} pixels {self.encoding}, expected {least}: its driver is bad")
        if len(self.data) != height * self.step:
            raise BadFrame(
                f"{len(self.data)} bytes, expected {height} rows of {self.step}: it was cut, or its driver is bad"
            )
        rows = self.data.reshape(height, self.step)[:, :least]
        return convert(np.ascontiguousarray(rows).view(kind))


class CompressedPicture(NamedTuple):
    """A sensor_msgs/CompressedImage of the transport compressedDepth. stamp [ns]; format: encoding; codec."""

    stamp: int
    frame: str
    format: str
    data: Bytes

    def millimetres(self, width: int, height: int) -> Depth:
        """(height, width) [mm], 0 = no return. Raises BadFrame for an image of another size or codec."""
        encoding = self.format.partition(";")[0].strip()
        conversion(encoding)
        content = self.data.tobytes()
        if content[QUANTISER.size : QUANTISER.size + len(PNG)] != PNG:
            raise BadFrame(f"format {self.format!r} has no PNG in it: set the driver's compressedDepth format to png")
        levels = decode_depth(content[QUANTISER.size :], "compressedDepth", width, height)
        if encoding == "16UC1":
            return levels
        _, a, b = QUANTISER.unpack_from(content)
        with np.errstate(divide="ignore", invalid="ignore"):
            return from_metres(np.where(levels > 0, np.float32(a) / (levels - np.float32(b)), np.float32(0)))


def from_metres(depth: NDArray[np.float32]) -> Depth:
    """Depths [m] as millimetres; what is not finite, not ahead or too far for 16 bits is no return."""
    scaled = np.rint(depth * np.float32(1000.0))
    return np.where((scaled > 0) & (scaled <= LARGEST), scaled, 0).astype(np.uint16)


def as_they_are(depth: Depth) -> Depth:
    """Depths that are millimetres."""
    return depth.astype(np.uint16)  # in a buffer of our own


ENCODINGS: dict[str, tuple[np.dtype[Any], Callable[[NDArray[Any]], Depth]]] = {
    "16UC1": (np.dtype("<u2"), as_they_are),
    "32FC1": (np.dtype("<f4"), from_metres),
}


def conversion(encoding: str) -> tuple[np.dtype[Any], Callable[[NDArray[Any]], Depth]]:
    """A pixel's type in an encoding, and what makes millimetres of such. Raises BadFrame for no depth."""
    if encoding not in ENCODINGS:
        raise BadFrame(f"encoding {encoding!r} is no depth, expected {' or '.join(ENCODINGS)}: name a depth topic")
    return ENCODINGS[encoding]
