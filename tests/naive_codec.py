"""The slow twin of the depth codec: pixel by pixel, as common/contract/depth_codec.py describes the format."""

import numpy as np
import zstandard


def encode(depth):
    """The bytes of `depth` (rows, columns) [mm] as LEVELS."""
    levels = sorted(set(depth.ravel().tolist()))
    place_of = {level: place for place, level in enumerate(levels)}
    low, high = bytearray(), bytearray()
    for row in depth.tolist():
        left = 0
        for value in row:
            step = (place_of[value] - left + 2**15) % 2**16 - 2**15
            folded = 2 * step if step >= 0 else -2 * step - 1
            low.append(folded % 256)
            high.append(folded // 256)
            left = place_of[value]
    header = b"".join(number.to_bytes(2, "little") for number in [len(levels) % 2**16, *levels])
    return header + zstandard.ZstdCompressor(level=1).compress(bytes(low + high))


def decode(data, width, height):
    """The depth image (height, width) [mm] in the bytes of a good LEVELS image."""
    count = int.from_bytes(data[:2], "little") or 2**16
    levels = [int.from_bytes(data[at : at + 2], "little") for at in range(2, 2 + 2 * count, 2)]
    planes = zstandard.ZstdDecompressor().decompress(data[2 + 2 * count :])
    depth = np.empty((height, width), np.uint16)
    for row in range(height):
        place = 0
        for column in range(width):
            at = row * width + column
            folded = planes[at] + 256 * planes[width * height + at]
            place = (place + (folded // 2 if folded % 2 == 0 else -(folded + 1) // 2)) % 2**16
            depth[row, column] = levels[place]
    return depth
