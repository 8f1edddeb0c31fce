"""A short queue between the thread that receives and the one that works: the newest wins."""

import threading
from collections import deque
from typing import Generic, TypeVar

T = TypeVar("T")


class LatestQueue(Generic[T]):
    """Holds the newest `room` items; by default one, so that a slow reader never falls behind."""

    def __init__(self, room: int = 1) -> None:
        self._items: deque[T] = deque(maxlen=room)
        self._arrived = threading.Condition()

    def put(self, item: T) -> bool:
        """Add an item. False where the oldest one had to make room."""
        with self._arrived:
            had_room = len(self._items) < (self._items.maxlen or 0)
            self._items.append(item)
            self._arrived.notify()
        return had_room

    def get(self, timeout: float) -> T | None:
        """The oldest item held, or None where none came within `timeout` [s]."""
        with self._arrived:
            self._arrived.wait_for(self._items.__len__, timeout)
            return self._items.popleft() if self._items else None
