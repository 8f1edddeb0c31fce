"""The Kobuki's byte stream as frames: `AA 55 | length | payload | checksum`.

The length counts the payload's bytes, 0 to 255; the checksum is the XOR of length and payload. Source: Kobuki protocol.
"""

from typing import NamedTuple

HEADER = b"\xaa\x55"
LONGEST_PAYLOAD = 255
OVERHEAD = len(HEADER) + 2  # length and checksum


class FrameCounts(NamedTuple):
    """What a parser has met so far; every byte belongs to a good frame, was skipped, or is still undecided."""

    good: int  # frames
    bad_checksums: int  # headers whose frame does not end in its checksum
    skipped: int  # bytes of no good frame


class FrameParser:
    """Finds the frames in a stream of bytes, however it is cut.

    A frame is good where the stream, read from left to right, has a header, the checksum agrees, and the frame is not
    an impostor: one check in 256 agrees by chance, so a payload that is no sequence of sub-payloads is not believed
    if a whole frame with a payload that is one lies inside it. After a good frame the search goes on behind it, after
    anything else at the very next byte. A frame comes out with its last byte, and what has come out after each byte
    depends on the bytes so far and on nothing else.

    So a packet can be lost only to a good frame that begins before it, in garbage, and by chance covers its header. It
    is always found right behind another one, behind garbage without `AA 55`, and behind as many bytes without `AA 55`
    as the longest frame has. A false header holds back what follows until the frame it claims is complete, 259 bytes
    at most.
    """

    def __init__(self) -> None:
        self._rest = b""  # begins with a header or the first half of one; shorter than the longest frame
        self._counts = FrameCounts(0, 0, 0)

    @property
    def counts(self) -> FrameCounts:
        """Frames and bytes so far."""
        return self._counts

    def feed(self, chunk: bytes) -> list[bytes]:
        """The payloads of all good frames that `chunk` completes, in order."""
        stream = self._rest + chunk
        payloads = []
        good, bad, skipped = self._counts
        place = 0
        while True:
            start = _next_header(stream, place)
            skipped += start - place
            end = _end_of_frame(stream, start)
            if end > len(stream):
                break
            if not _checks(stream, start, end):
                bad += 1
            elif not _is_impostor(stream, start, end):
                payloads.append(stream[start + 3 : end - 1])
                good += 1
                place = end
                continue
            skipped += 1
            place = start + 1
        self._rest = stream[start:]
        self._counts = FrameCounts(good, bad, skipped)
        return payloads


def frame(payload: bytes) -> bytes:
    """The frame that carries `payload`. Raises ValueError where it is too long."""
    if len(payload) > LONGEST_PAYLOAD:
        raise ValueError(f"payload of {len(payload)} bytes, expected at most {LONGEST_PAYLOAD}")
    body = bytes([len(payload)]) + payload
    return HEADER + body + bytes([_parity(body)])


def _next_header(stream: bytes, place: int) -> int:
    """Where the next header begins, or the half of one that ends the stream, or the stream's end."""
    start = stream.find(HEADER, place)
    return start if start >= 0 else len(stream) - stream.endswith(HEADER[:1], place)


def _end_of_frame(stream: bytes, start: int) -> int:
    """Where the frame that begins at `start` ends; beyond the stream's end where its length has not come yet."""
    place = start + len(HEADER)
    return start + OVERHEAD + stream[place] if place < len(stream) else len(stream) + 1


def _checks(stream: bytes, start: int, end: int) -> bool:
    return _parity(stream[start + 2 : end - 1]) == stream[end - 1]


def _is_impostor(stream: bytes, start: int, end: int) -> bool:
    """Whether a frame that checks must give way to a better one inside it."""
    inner = start
    while (inner := stream.find(HEADER, inner + 1, end)) >= 0:
        inner_end = _end_of_frame(stream, inner)
        if inner_end <= end and _checks(stream, inner, inner_end) and _is_sequence(stream[inner + 3 : inner_end - 1]):
            return not _is_sequence(stream[start + 3 : end - 1])
    return False


def _is_sequence(payload: bytes) -> bool:
    """Whether sub-payloads, `id | length | data`, fill a payload."""
    place = 0
    while place + 1 < len(payload):
        place += 2 + payload[place + 1]
    return place == len(payload) > 0


def _parity(body: bytes) -> int:
    """XOR of up to 256 bytes: one long number folded in halves, which takes eight steps rather than one a byte."""
    number = int.from_bytes(body, "little")
    for half in (1024, 512, 256, 128, 64, 32, 16, 8):
        number ^= number >> half
    return number & 0xFF
