"""A link between two TUN devices, as a process of its own: python -m benchmarks.link.emulator DEVICE DEVICE.

Each line on its standard input is a JSON map that may set `link`, the fields of a Link, and `down`; each is answered by
a line with what was carried and lost so far. It makes the devices, so it needs root, and ends with its input.
"""

import fcntl
import json
import os
import random
import select
import struct
import sys
import time
from collections import deque
from contextlib import suppress

from benchmarks.link.path import Link, Path

TUNSETIFF = 0x400454CA
IFF_TUN, IFF_NO_PI = 0x0001, 0x1000
LARGEST = 2048  # [bytes] more than a device's MTU
AT_ONCE = 64  # packets that are read before others get their turn
LONGEST = 1.0  # [s] of a wait
SEED = 7


def open_tun(name: str) -> int:
    """A new TUN device's file; the device is gone when it is closed. Raises OSError."""
    device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TUN | IFF_NO_PI))
    return device


class Direction:
    """Packets on their way from one device to the other."""

    def __init__(self, source: int, target: int) -> None:
        self.source, self._target = source, target
        self.path = Path(Link(1e9), random.Random(SEED + source))
        self._flying: deque[tuple[float, bytes]] = deque()

    def take_in(self) -> None:
        """Send on its way what waits at the source."""
        for _ in range(AT_ONCE):
            try:
                packet = os.read(self.source, LARGEST)
            except BlockingIOError:
                return
            arrival = self.path.arrival(len(packet), time.monotonic())
            if arrival is not None:
                self._flying.append((arrival, packet))

    def deliver(self) -> float:
        """Hand over what has arrived; how long [s] it is until the next packet does."""
        while self._flying:
            left = self._flying[0][0] - time.monotonic()
            if left > 0.0:
                return left
            packet = self._flying.popleft()[1]
            if not self.path.down:
                _write(self._target, packet)
        return LONGEST


def _write(device: int, packet: bytes) -> None:
    """Hand a packet to a device; one that is not up yet does not take it."""
    with suppress(OSError):
        os.write(device, packet)


def obey(line: str, directions: tuple[Direction, Direction]) -> str:
    """Do what a line asks; the answer."""
    asked = json.loads(line)
    for path in (direction.path for direction in directions):
        path.link = Link(*asked.get("link", path.link))
        path.down = asked.get("down", path.down)
    return json.dumps([{"carried": each.path.carried, "lost": each.path.lost} for each in directions])


def main() -> None:
    """Carry packets until the input ends."""
    one, other = (open_tun(name) for name in sys.argv[1:3])
    directions = Direction(one, other), Direction(other, one)
    print("[]", flush=True)
    while True:
        left = min([direction.deliver() for direction in directions])
        ready, _, _ = select.select([one, other, 0], [], [], left)
        for direction in directions:
            if direction.source in ready:
                direction.take_in()
        if 0 in ready:
            line = sys.stdin.readline()
            if not line:
                return
            print(obey(line, directions), flush=True)


if __name__ == "__main__":
    main()
