"""A message to the page: a JSON header and arrays, which the page's packet.js reads without a copy.

u32 number, u32 length of the header, the header, then each array, little-endian, on a multiple of eight bytes. The
header's `arrays` says of each array its type, where it begins after the header, and how many values it has.
"""

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

ALIGNED = 8  # bytes
PREFIX = struct.Struct("<II")


def packet(header: Mapping[str, object], arrays: Mapping[str, NDArray[Any]] | None = None) -> bytes:
    """Everything but the number, which differs from one viewer to the next."""
    described: dict[str, object] = {}
    parts: list[bytes] = []
    at = 0
    for name, values in (arrays or {}).items():
        payload = np.ascontiguousarray(values).tobytes()
        described[name] = {"type": values.dtype.str[1:], "at": at, "length": values.size}
        parts.append(payload + bytes(-len(payload) % ALIGNED))
        at += len(parts[-1])
    text = json.dumps({**header, "arrays": described}, allow_nan=False).encode()
    text += b" " * (-(PREFIX.size + len(text)) % ALIGNED)
    return struct.pack("<I", len(text)) + text + b"".join(parts)


def numbered(number: int, body: bytes) -> bytes:
    """A packet with the number that acknowledges it."""
    return struct.pack("<I", number) + body
