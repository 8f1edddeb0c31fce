"""Whose samples are worked on next, where those of several robots wait."""

import threading
from collections import deque

ROOM = 2  # samples of a robot that wait; a bad one shall not take a good one's place
MOST = 64  # robots of which samples wait


class Turns:
    """The newest samples of each robot. The robot comes next that has had the least time; then all of its samples do.

    So a robot whose frames are many, large or bad delays another by the work on one turn, and no more. Where all get
    what they ask for, they come in the order in which their samples came. Safe to use from any thread.
    """

    def __init__(self) -> None:
        self._arrived = threading.Condition()
        self._waiting: dict[str, deque[bytes]] = {}
        self._had: dict[str, float] = {}  # [s]; a robot that is not in it has had `_level`
        self._level = 0.0
        self._at_work = False

    def admits(self, robot: str) -> bool:
        """Whether there is room for a sample of this robot."""
        with self._arrived:
            return robot in self._waiting or len(self._waiting) < MOST

    def is_idle(self) -> bool:
        """Whether nothing waits and the last turn has been spent."""
        with self._arrived:
            return not (self._waiting or self._at_work)

    def put(self, robot: str, sample: bytes) -> bool:
        """Add a sample. False where an older one of the same robot had to make room."""
        with self._arrived:
            samples = self._waiting.setdefault(robot, deque(maxlen=ROOM))
            had_room = len(samples) < ROOM
            samples.append(sample)
            self._arrived.notify()
        return had_room

    def take(self, timeout: float) -> tuple[str, list[bytes]] | None:
        """The next robot and its samples, oldest first; None where none came within `timeout` [s]."""
        with self._arrived:
            if not self._arrived.wait_for(self._waiting.__len__, timeout):
                return None
            robot = min(self._waiting, key=self._time_of)
            self._level = self._time_of(robot)
            self._at_work = True
            self._had = {each: had for each, had in self._had.items() if had > self._level}
            return robot, list(self._waiting.pop(robot))

    def drop(self, robot: str) -> None:
        """Forget the samples of a robot."""
        with self._arrived:
            self._waiting.pop(robot, None)

    def spent(self, robot: str, seconds: float) -> None:
        """The robot's turn took so long."""
        with self._arrived:
            self._had[robot] = self._time_of(robot) + seconds
            self._at_work = False

    def _time_of(self, robot: str) -> float:
        """Time [s] that a robot has had; one that asked for less than others has no claim to make up for it."""
        return max(self._had.get(robot, 0.0), self._level)
