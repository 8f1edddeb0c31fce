"""How fast a Kobuki's bytes become measurements: python -m benchmarks.kobuki_parser [--megabytes N].

The stream is what the base sends, 77 and 83 bytes of payload by turns, with a hundredth of the packets damaged and as
much noise between them. It comes in pieces, as from a port. Beside it, a parser that looks at one byte at a time.
A base sends 0.004 MB/s.
"""

import argparse
import random
from collections.abc import Callable, Iterable
from time import perf_counter
from typing import NamedTuple

from cliffscan.services.kobuki.protocol.frames import FrameParser, frame
from cliffscan.services.kobuki.protocol.packets import decode
from tests.kobuki_stream import NaiveParser, usual_payload

Feed = Callable[[bytes], list[bytes]]

MEGABYTE = 1_000_000
REPEATS = 3
PIECE = 512  # bytes


class Result(NamedTuple):
    """Megabytes a second, and packets found."""

    rate: float
    packets: int


def stream_of(megabytes: float) -> bytes:
    """A stream of that size, always the same."""
    dice = random.Random(3)
    packets: list[bytes] = []
    size = 0
    while size < megabytes * MEGABYTE:
        n = len(packets)
        packet = bytearray(frame(usual_payload(20 * n & 0xFFFF, 31 * n & 0xFFFF, 29 * n & 0xFFFF, 2 + n % 2)))
        if dice.random() < 0.01:
            packet[dice.randrange(len(packet))] ^= 1 << dice.randrange(8)
        if dice.random() < 0.01:
            packet += dice.randbytes(len(packet))
        packets.append(bytes(packet))
        size += len(packet)
    return b"".join(packets)


def measured(parser: Callable[[], Feed], pieces: Iterable[bytes], decoding: bool) -> Result:
    """The best of some runs over all pieces."""
    best, packets = float("inf"), 0
    for _ in range(REPEATS):
        feed = parser()
        start = perf_counter()
        packets = 0
        for piece in pieces:
            payloads = feed(piece)
            packets += len(payloads)
            if decoding:
                for payload in payloads:
                    decode(payload)
        best = min(best, perf_counter() - start)
    return Result(sum(map(len, pieces)) / best / MEGABYTE, packets)


def main() -> None:
    """Print a line of each parser."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--megabytes", type=float, default=4.0)
    stream = stream_of(options.parse_args().megabytes)
    pieces = [stream[place : place + PIECE] for place in range(0, len(stream), PIECE)]
    print(f"{len(stream) / MEGABYTE:.1f} MB in pieces of {PIECE} bytes, best of {REPEATS}; target 2 MB/s")
    print(f"{'parser':<16}{'packets':>10}{'frames MB/s':>14}{'and decode MB/s':>18}")
    for name, parser in (("FrameParser", lambda: FrameParser().feed), ("byte by byte", lambda: NaiveParser().feed)):
        frames, both = (measured(parser, pieces, decoding) for decoding in (False, True))
        print(f"{name:<16}{frames.packets:>10}{frames.rate:>14.2f}{both.rate:>18.2f}")


if __name__ == "__main__":
    main()
