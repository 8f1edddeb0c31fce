"""CDR, the bytes of ROS 2 messages: little-endian, each number aligned to its size. Source: OMG DDSI-RTPS, XCDR1."""

import struct
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

HEADER = b"\x00\x01\x00\x00"  # plain CDR, little-endian; numbers are aligned from its end on
SECOND = 1_000_000_000  # [ns]
LAST_SECOND = 2**31 - 1
LARGEST, PART = 8, 4  # [bytes] of a number, of all and of those in a part()


class CdrError(ValueError):
    """Bytes are not the message that they should be; the text says why."""


@cache
def packer(code: str, count: int, place: int) -> struct.Struct:
    """What packs so many numbers of struct's code at a place in a message, modulo LARGEST, padding before them."""
    padding = (len(HEADER) - place) % struct.calcsize(f"<{code}")
    return struct.Struct(f"<{padding}x{count}{code}")


@lru_cache(256)
def _text(text: str, place: int) -> bytes:
    """A string as it is at a place; frames and names come again and again."""
    data = text.encode() + b"\0"
    return packer("I", 1, place).pack(len(data)) + data


class Writer:
    """Builds a message field by field, in the order of its definition."""

    def __init__(self) -> None:
        self._bytes = bytearray(HEADER)

    def numbers(self, code: str, *values: float) -> None:
        """Numbers of one type by struct's code, as a fixed-size array has them: without a length."""
        self._bytes += packer(code, len(values), len(self._bytes) % LARGEST).pack(*values)

    def text(self, text: str) -> None:
        """A string."""
        self._bytes += _text(text, len(self._bytes) % LARGEST)

    def sequence(self, values: NDArray[Any]) -> None:
        """A sequence of numbers: its length and its values, whose type the array has."""
        self.numbers("I", values.size)
        if values.size:
            self._align(values.itemsize)
            self._bytes += np.ascontiguousarray(values, values.dtype.newbyteorder("<")).data.cast("B")

    def part(self, data: bytes) -> None:
        """Fields of no more than PART bytes each, which a Writer wrote for themselves."""
        self._align(PART)
        self._bytes += data[len(HEADER) :]

    def stamp(self, stamp: int) -> None:
        """A builtin_interfaces/Time of a stamp [ns]. Raises CdrError for one that ROS cannot express."""
        seconds, nanoseconds = divmod(stamp, SECOND)
        if seconds > LAST_SECOND:
            raise CdrError(f"stamp {stamp} lies after 2038, the last year of ROS time: correct the clock")
        self.numbers("i", seconds, nanoseconds)

    def header(self, stamp: int, frame: str) -> None:
        """A std_msgs/Header. Raises CdrError as stamp() does."""
        self.stamp(stamp)
        self.text(frame)

    def payload(self) -> bytes:
        """The message."""
        return bytes(self._bytes)

    def body(self) -> bytes:
        """The message without what all begin with."""
        return bytes(self._bytes[len(HEADER) :])

    def _align(self, size: int) -> None:
        if past := (len(self._bytes) - len(HEADER)) % size:
            self._bytes += bytes(size - past)


class Reader:
    """Reads a message field by field. All methods raise CdrError.

    sent [ns]: when it was sent, on the sender's clock; 0 where that is not known.
    """

    def __init__(self, payload: bytes, sent: int = 0) -> None:
        if payload[:2] != HEADER[:2]:
            raise CdrError(f"begins with {payload[:4].hex()!r}, expected {HEADER.hex()!r}: little-endian CDR")
        self.sent = sent
        self._body = memoryview(payload)[len(HEADER) :]
        self._at = 0

    def numbers(self, code: str, count: int) -> tuple[Any, ...]:
        """Numbers of one type by struct's code."""
        size = struct.calcsize(code)
        self._at += -self._at % size
        return struct.unpack(f"<{count}{code}", self._take(count * size))

    def text(self) -> str:
        """A string."""
        (length,) = self.numbers("I", 1)
        try:
            return bytes(self._take(length)).rstrip(b"\0").decode()
        except UnicodeDecodeError as error:
            raise CdrError(f"a string is not UTF-8: {error.reason}") from error

    def sequence(self, kind: type[np.generic]) -> NDArray[Any]:
        """A sequence of numbers: (length,), which shares the message's memory."""
        item = np.dtype(kind).newbyteorder("<")
        (length,) = self.numbers("I", 1)
        if length:
            self._at += -self._at % item.itemsize
        return np.frombuffer(self._take(length * item.itemsize), item)

    def header(self) -> tuple[int, str]:
        """Stamp [ns] and frame of a std_msgs/Header."""
        (seconds,), (nanoseconds,) = self.numbers("i", 1), self.numbers("I", 1)
        return seconds * SECOND + nanoseconds, self.text()

    def _take(self, size: int) -> memoryview:
        part = self._body[self._at : self._at + size]
        if len(part) < size:
            raise CdrError(f"ends after {len(self._body)} bytes, expected {self._at + size} at least")
        self._at += size
        return part
