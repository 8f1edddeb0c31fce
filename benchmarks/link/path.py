"""One direction of a link that takes its time, and loses: what a packet's way takes, by the caller's clock."""

import random
from typing import NamedTuple


class Link(NamedTuple):
    """How a link carries packets, alike in both directions."""

    rate: float  # [bit/s]
    delay: float = 0.0  # [s] one way
    jitter: float = 0.0  # [s] by which the delay varies to either side
    loss: float = 0.0  # share of the packets
    queue: float = 0.1  # [s] for which packets may wait to be sent; what would wait longer is dropped


class Path:
    """One direction. Packets stay in order, as on Wi-Fi; each takes the link for its own time."""

    def __init__(self, link: Link, rng: random.Random) -> None:
        self.link = link
        self.down = False  # nothing gets through
        self.carried = 0  # [bytes] so far
        self.lost = 0  # packets
        self._rng = rng
        self._busy_until = self._last = 0.0  # [s]

    def arrival(self, size: int, now: float) -> float | None:
        """When [s] a packet of `size` bytes that is sent now arrives; None where it does not."""
        starts = max(now, self._busy_until)
        if self.down or starts - now > self.link.queue:
            self.lost += 1
            return None
        self._busy_until = starts + 8 * size / self.link.rate
        if self._rng.random() < self.link.loss:  # on the air, for it has taken its time
            self.lost += 1
            return None
        self.carried += size
        delay = self.link.delay + self._rng.uniform(-self.link.jitter, self.link.jitter)
        self._last = max(self._last, self._busy_until + delay)
        return self._last
