"""Whose scan of a frame is published where a workstation perceives too: its own while they come in time, else ours.

Both answer the same frames. It is decided on the robot, where it is known when each came, so nobody's clock matters.
"""

import math
import threading
from typing import NamedTuple

IN_TIME = 0.2  # [s] after a frame in which the workstation's scan of it is in time
SETTLED = 1.0  # [s] in which all of them were, before they are published again
REMEMBERED = 64  # frames


class Arrival(NamedTuple):
    """A frame that came."""

    place: int  # in the order of arrival
    at: float  # [s]


class Handover:
    """Times are the caller's [s], on any clock that does not go back. Safe to use from any thread.

    At first the robot answers. Of each frame one scan is published at most, and none older than the last one.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._came: dict[int, Arrival] = {}  # the last frames by sequence number, in order of arrival
        self._place = 0  # of the newest
        self._published = self._offered = 0  # places of the last scan, and of the workstation's last in time
        self._good_since = math.inf  # since when the workstation's are in time
        self.ours = True  # whether the robot answers

    def frame(self, seq: int, now: float) -> bool:
        """A frame came; whether the robot is to answer it."""
        with self._lock:
            self._place += 1
            self._came.pop(seq, None)
            self._came[seq] = Arrival(self._place, now)
            if len(self._came) > REMEMBERED:
                del self._came[next(iter(self._came))]
            waiting = next(each for each in self._came.values() if each.place > self._offered)
            if now - waiting.at > IN_TIME:
                self.ours, self._good_since = True, math.inf
            return self.ours

    def offer(self, seq: int, now: float) -> bool:
        """The workstation's scan of a frame came; whether it is to be published."""
        with self._lock:
            came = self._came.get(seq)
            if came is None:
                return False
            if now - came.at > IN_TIME:
                self._good_since = math.inf
                return False
            self._offered = max(self._offered, came.place)
            self._good_since = min(self._good_since, now)
            if now - self._good_since >= SETTLED:
                self.ours = False
            return not self.ours and self._is_news(came)

    def answer(self, seq: int) -> bool:
        """The robot's own scan of a frame is ready; whether it is to be published."""
        with self._lock:
            came = self._came.get(seq)
            return came is not None and self.ours and self._is_news(came)

    def _is_news(self, came: Arrival) -> bool:
        """Whether no scan of this frame or a later one was published; from now on one is."""
        if came.place <= self._published:
            return False
        self._published = came.place
        return True
