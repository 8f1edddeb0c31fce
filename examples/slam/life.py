"""When to do things, and when to end."""

import signal
import time
from types import FrameType


class Stop:
    """Asked for by SIGTERM and Ctrl-C."""

    def __init__(self) -> None:
        self.asked = False
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_signal)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self.asked = True


class Pace:
    """Says when something that has to be done may be done, at most once in so many seconds."""

    def __init__(self, period: float) -> None:
        self._period = period
        self._next = time.monotonic()

    def due(self) -> bool:
        """Whether it may be done now; if so, the next time is a period from now."""
        now = time.monotonic()
        if now < self._next:
            return False
        self._next = now + self._period
        return True
