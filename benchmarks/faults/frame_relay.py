"""Stands between a simulation and capture, and hands frames on late, again and again, or not at all."""

import time
from collections import deque
from typing import Literal

from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer
from cliffscan.simulator.wire import WireFrame
from evaluation.processes.truth_feed import FrameFeed

Mode = Literal["pass", "late", "frozen", "repeated", "dropped"]

LATE = 0.6  # [s] of a late frame


class FrameRelay:
    """Hears frames at one address and tells them at another. Raises OSError, WireError."""

    def __init__(self, source: str, address: str) -> None:
        self.become("pass")
        self._server = FrameServer(address)
        self._waiting: deque[tuple[float, WireFrame]] = deque()  # when it came, and the frame
        self._last: WireFrame
        self._feed = FrameFeed(source, self._hand_on)

    def become(self, mode: Mode) -> None:
        """Treat frames so from now on."""
        self._mode, self._delay = mode, LATE if mode == "late" else 0.0

    def close(self) -> None:
        """Hang up on both sides."""
        self._feed.close()
        self._server.close()

    def _hand_on(self, frame: WireFrame) -> None:
        """Treat a frame as the mode says.

        A frozen camera repeats its last image with the stamp that it had, a hung driver repeats it with a fresh one.
        """
        if self._mode == "dropped":
            return
        if self._mode == "frozen":
            self._server.offer(wire.pack(*self._last))
            return
        if self._mode == "repeated":
            header, image = self._last
            self._server.offer(wire.pack({**header, "stamp": frame[0]["stamp"]}, image))
            return
        self._waiting.append((time.monotonic(), frame))
        while self._waiting and time.monotonic() - self._waiting[0][0] >= self._delay:
            self._last = self._waiting.popleft()[1]
            self._server.offer(wire.pack(*self._last))
