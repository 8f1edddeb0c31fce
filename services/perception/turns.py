"""Whose samples are worked on next, where those of several robots wait."""

import threading
from collections import deque

ROOM = 2  # samples of a robot that wait; a bad one shall not take a good one's place
MOST = 64  # robots of which samples wait, and as many strangers
STRANGERS = ""  # whose time is that of all of them; no robot has this name


class Turns:
    """The newest samples of each robot. The robot comes next that has had the least time; then all of its samples do.

    So a robot whose frames are many, large or bad delays another by the work on one turn, and no more. Robots that are
    not known have together the time of one, for anybody can make up new names. Where all get what they ask for, they
    come in the order in which their samples came. Safe to use from any thread.
    """

    def __init__(self) -> None:
        self._arrived = threading.Condition()
        self._waiting: dict[str, deque[bytes]] = {}
        self._strangers: set[str] = set()  # of those that wait
        self._had: dict[str, float] = {}  # [s]; a robot that is not in it has had `_level`
        self._level = 0.0
        self._at_work: str | None = None  # whose time the turn takes

    def admits(self, robot: str, known: bool = True) -> bool:
        """Whether there is room for a sample of this robot."""
        with self._arrived:
            strangers = len(self._strangers)
            return robot in self._waiting or (len(self._waiting) - strangers if known else strangers) < MOST

    def is_idle(self) -> bool:
        """Whether nothing waits and the last turn has been spent."""
        with self._arrived:
            return not self._waiting and self._at_work is None

    def put(self, robot: str, sample: bytes, known: bool = True) -> bool:
        """Add a sample. False where an older one of the same robot had to make room."""
        with self._arrived:
            samples = self._waiting.setdefault(robot, deque(maxlen=ROOM))
            had_room = len(samples) < ROOM
            samples.append(sample)
            (self._strangers.discard if known else self._strangers.add)(robot)
            self._arrived.notify()
        return had_room

    def take(self, timeout: float) -> tuple[str, list[bytes]] | None:
        """The next robot and its samples, oldest first; None where none came within `timeout` [s]."""
        with self._arrived:
            if not self._arrived.wait_for(self._waiting.__len__, timeout):
                return None
            robot = min(self._waiting, key=self._time_of)
            self._level = self._time_of(robot)
            self._at_work = self._account(robot)
            self._had = {each: had for each, had in self._had.items() if had > self._level}
            self._strangers.discard(robot)
            return robot, list(self._waiting.pop(robot))

    def drop(self, robot: str) -> None:
        """Forget the samples of a robot."""
        with self._arrived:
            self._waiting.pop(robot, None)
            self._strangers.discard(robot)

    def spent(self, seconds: float) -> None:
        """The turn that was taken last took so long."""
        with self._arrived:
            if self._at_work is not None:
                self._had[self._at_work] = max(self._had.get(self._at_work, 0.0), self._level) + seconds
            self._at_work = None

    def _account(self, robot: str) -> str:
        return STRANGERS if robot in self._strangers else robot

    def _time_of(self, robot: str) -> float:
        """Time [s] that a robot has had; one that asked for less than others has no claim to make up for it."""
        return max(self._had.get(self._account(robot), 0.0), self._level)
