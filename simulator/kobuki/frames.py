"""Frames on the wire: AA 55, the payload's length, the payload, and the XOR of length and payload."""

from functools import reduce
from operator import xor

HEADER = b"\xaa\x55"
SHORTEST_COMMAND = 3  # [bytes] of payload: an identifier, a length and one byte of data
LONGEST_COMMAND = 64  # [bytes] of payload; one of every command fills 40, and a false header must not swallow many


def frame(payload: bytes) -> bytes:
    """A payload with header, length and checksum. Raises ValueError for one that no length byte can tell."""
    if not 0 < len(payload) < 256:
        raise ValueError(f"payload of {len(payload)} bytes, expected 1 to 255")
    body = bytes([len(payload)]) + payload
    return HEADER + body + bytes([checksum(body)])


def checksum(data: bytes) -> int:
    """The XOR of all bytes; 0 over a length, its payload and their checksum."""
    return reduce(xor, data, 0)


class FrameFinder:
    """Finds the commands in a stream of bytes that may be cut anywhere and may hold anything else between them.

    What is no frame is left out byte by byte, so that a false header never takes a true one along.
    """

    def __init__(self) -> None:
        self.discarded = 0  # [bytes] that belonged to no frame
        self._pending = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """The payloads that are complete with these bytes, in order."""
        self._pending += data
        payloads = []
        while (payload := self._next()) is not None:
            payloads.append(payload)
        return payloads

    def _next(self) -> bytes | None:
        while self._at_header():
            size = self._pending[2] + 4
            if not SHORTEST_COMMAND <= size - 4 <= LONGEST_COMMAND:
                self._discard(1)
                continue
            if len(self._pending) < size:
                return None
            body = bytes(self._pending[2:size])
            if checksum(body) == 0:
                del self._pending[:size]
                return body[1:-1]
            self._discard(1)
        return None

    def _at_header(self) -> bool:
        """Leave out what precedes the next header; True where its length has come as well."""
        start = self._pending.find(HEADER)
        if start < 0:  # the last byte may be the first half of a header
            start = len(self._pending) - self._pending.endswith(HEADER[:1])
        self._discard(start)
        return len(self._pending) > len(HEADER)

    def _discard(self, count: int) -> None:
        del self._pending[:count]
        self.discarded += count
