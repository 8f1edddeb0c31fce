"""Depth images as bytes: raw, or without loss at an eighth of the size.

A Kinect measures in steps: a frame of 300,000 pixels holds some 300 to 1,000 different depths. `LEVELS` sends
those depths once, in ascending order, and each pixel as its place among them, less its left neighbour's; these
small numbers, folded to unsigned (0, -1, 1, -2 … → 0, 1, 2, 3 …) and split into a plane of low and a plane of
high bytes, are what zstandard compresses.
"""

from collections.abc import Callable

import numpy as np
import zstandard
from numpy.typing import NDArray

RAW = "16UC1"
LEVELS = "16UC1;levels;zstd"
ENCODINGS = (LEVELS, RAW)
FAST, SMALL = 1, 6  # effort of zstandard; a tenth fewer bytes for a millisecond or two

Bytes = NDArray[np.uint8]
Depth = NDArray[np.uint16]
COUNT = np.dtype("<u2")
MOST = 65_536  # levels there can be; their count is then written as 0


def encode(depth: Depth, encoding: str, effort: int = FAST) -> bytes:
    """The bytes of `depth` (rows, columns) [mm] in one of ENCODINGS."""
    if encoding == RAW:
        return depth.astype("<u2", copy=False).tobytes()
    levels, places = _places(np.ascontiguousarray(depth))
    steps = places.copy()
    np.subtract(places[:, 1:], places[:, :-1], out=steps[:, 1:])
    folded = (steps << 1) ^ (steps.view(np.int16) >> 15).view(np.uint16)
    planes = np.empty((2, *depth.shape), np.uint8)
    planes[0] = folded & 0xFF
    planes[1] = folded >> 8
    header = np.concatenate(([len(levels) % MOST], levels)).astype(COUNT).tobytes()
    return header + zstandard.ZstdCompressor(level=effort).compress(planes.tobytes())


def decode(data: bytes, encoding: str, width: int, height: int) -> Depth:
    """The depth image (height, width) [mm] in `data`. Raises ValueError where the bytes do not hold one."""
    size = 2 * width * height
    if encoding == RAW:
        if len(data) != size:
            raise ValueError(f"{len(data)} bytes, expected {size} for {width}x{height}")
        return np.frombuffer(data, "<u2").astype(np.uint16, copy=False).reshape(height, width)
    if encoding != LEVELS:
        raise ValueError(f"unknown encoding {encoding!r}, expected one of {', '.join(ENCODINGS)}")
    levels, compressed = _split_header(data)
    planes = np.frombuffer(_decompress(compressed, size), np.uint8).reshape(2, height, width)
    of_any_place, depth = np.zeros(MOST, np.uint16), np.empty((height, width), np.uint16)
    of_any_place[: len(levels)] = levels
    highest = _levels_loop()(planes[0], planes[1], of_any_place, depth)
    if highest >= len(levels):
        raise ValueError(f"a pixel names level {highest} of {len(levels)}")
    return depth


def compile_loops() -> None:
    """Have decode() compiled before the first image comes."""
    decode(encode(np.zeros((2, 2), np.uint16), LEVELS), LEVELS, 2, 2)


def _levels_loop() -> Callable[[Bytes, Bytes, Depth, Depth], int]:
    """depth_levels.unfold; numba is loaded only by a process that decodes."""
    from cliffscan.common.contract.depth_levels import unfold

    return unfold


def _places(depth: Depth) -> tuple[Depth, Depth]:
    """The different depths, ascending, and each pixel's place among them (np.unique, ten times as fast)."""
    present = np.bincount(depth.ravel()) > 0
    place_of = np.cumsum(present, dtype=np.uint16) - np.uint16(1)
    return np.flatnonzero(present).astype(np.uint16), place_of.take(depth, mode="clip")


def _split_header(data: bytes) -> tuple[Depth, bytes]:
    count = int.from_bytes(data[: COUNT.itemsize], "little") or MOST
    end = COUNT.itemsize * (1 + count)
    if len(data) < end:
        raise ValueError(f"{len(data)} bytes are too short for {count} levels")
    return np.frombuffer(data[COUNT.itemsize : end], COUNT).astype(np.uint16, copy=False), data[end:]


def _decompress(data: bytes, size: int) -> bytes:
    """Exactly `size` bytes; a frame that claims any other size is refused before memory is taken for it."""
    try:
        claimed = zstandard.frame_content_size(data)
        if claimed != size:
            raise ValueError(f"holds {claimed} bytes, expected {size}")
        return zstandard.ZstdDecompressor().decompress(data, allow_extra_data=False)
    except zstandard.ZstdError as error:
        raise ValueError(f"zstandard: {error}") from error
