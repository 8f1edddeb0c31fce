"""A Kobuki's bytes, made by hand: what the parser's tests and its benchmark feed it, and its slow, obvious twin."""

import struct
from functools import reduce
from operator import xor

HEADER = b"\xaa\x55"


def framed(payload):
    body = bytes([len(payload), *payload])
    return HEADER + body + bytes([reduce(xor, body)])


def sub_payload(ident, layout, *values):
    data = struct.pack(layout, *values)
    return bytes([ident, len(data)]) + data


def core(
    timestamp=0, left=0, right=0, *, bumper=0, drop=0, cliff=0, pwm=(0, 0), buttons=0, charger=0, battery=160, over=0
):
    fields = (timestamp, bumper, drop, cliff, left, right, *pwm, buttons, charger, battery, over)
    return sub_payload(1, "<HBBBHHbbBBBB", *fields)


def inertia(angle=0, rate=0):
    return sub_payload(4, "<hh3x", angle, rate)


def gyro(*samples, frame_id=0):
    numbers = [number for sample in samples for number in sample]
    return sub_payload(13, f"<BB{len(numbers)}h", frame_id, len(numbers), *numbers)


def usual_payload(timestamp=0, left=0, right=0, samples=2):
    """What the base streams every 20 ms: 77 bytes with two samples of the gyro, 83 with three."""
    return (
        core(timestamp, left, right)
        + sub_payload(3, "<3B", 0, 0, 0)
        + inertia()
        + sub_payload(5, "<3H", 2050, 2060, 2070)
        + sub_payload(6, "<2B", 0, 0)
        + gyro(*[(1, -2, 3)] * samples)
        + sub_payload(16, "<5H6x", 0, 0, 0, 0, 0)
    )


class NaiveParser:
    """The frames of a stream that comes byte by byte, decided as soon as they can be."""

    def __init__(self):
        self.pending = []
        self.good, self.bad_checksums, self.skipped = 0, 0, 0

    def feed(self, chunk):
        payloads = []
        for byte in chunk:
            self.pending.append(byte)
            while self.pending and (decided := self._decide()):
                payloads += decided[0]
        return payloads

    def _decide(self):
        """Drop the first byte or the first frame if it is clear what it is: ([payload] or [],), else None."""
        pending = self.pending
        if pending[0] != 0xAA or (len(pending) > 1 and pending[1] != 0x55):
            return self._skip()
        if len(pending) < 3 or len(pending) < pending[2] + 4:
            return None
        end = pending[2] + 4
        if not checks(pending[:end]):
            self.bad_checksums += 1
            return self._skip()
        payload = pending[3 : end - 1]
        if not is_sequence(payload) and any(map(is_whole_packet, stretches(pending[1:end]))):
            return self._skip()
        self.good += 1
        self.pending = pending[end:]
        return ([bytes(payload)],)

    def _skip(self):
        self.skipped += 1
        del self.pending[0]
        return ([],)


def stretches(numbers):
    return (numbers[a:b] for a in range(len(numbers)) if numbers[a] == 0xAA for b in range(a + 4, len(numbers) + 1))


def is_whole_packet(numbers):
    return (
        bytes(numbers[:2]) == HEADER
        and numbers[2] + 4 == len(numbers)
        and checks(numbers)
        and is_sequence(numbers[3:-1])
    )


def checks(numbers):
    checksum = 0
    for byte in numbers[2:-1]:
        checksum ^= byte
    return checksum == numbers[-1]


def is_sequence(payload):
    if not payload:
        return False
    after = payload[2 + payload[1] :] if len(payload) > 1 else None
    whole = after is not None and 2 + payload[1] <= len(payload)
    return whole and (not after or is_sequence(after))
