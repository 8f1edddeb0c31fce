"""What waits for one viewer: of each kind only the newest, and no more on the way than it acknowledges.

Without that, frames pile up in the browser and the picture lags by half a second.
"""

import threading
import time
from collections.abc import Callable
from typing import NamedTuple

OUTSTANDING = 2  # messages on the way that are not acknowledged
NEVER = float("-inf")

Make = Callable[[], bytes | None]


class Waiting(NamedTuple):
    """A message that is made when it is sent."""

    make: Make
    born: float  # [s] when what it shows arrived


class Sent(NamedTuple):
    """A message whose turn it is, by the number that acknowledges it."""

    number: int
    make: Make


class Outbox:
    """Offered by any thread, taken by the one that sends.

    periods: the least time [s] between two messages of a kind, by its first word. Of those that are due, the kind that
    was sent the longest ago comes first. outstanding: None for a viewer that acknowledges nothing.
    """

    def __init__(self, periods: dict[str, float], outstanding: int | None = OUTSTANDING) -> None:
        self._periods = periods
        self._most = outstanding
        self._waiting: dict[str, Waiting] = {}
        self._sent_at: dict[str, float] = {}
        self._on_the_way: dict[int, tuple[str, float]] = {}
        self._number = 0
        self._closed = False
        self._changed = threading.Condition()

    def offer(self, kind: str, make: Make) -> None:
        """Let a message wait in the place of an older one of its kind."""
        with self._changed:
            self._waiting[kind] = Waiting(make, time.monotonic())
            self._changed.notify()

    def take(self) -> Sent | None:
        """The next message, as soon as there is one that may go; None once closed."""
        with self._changed:
            while not self._closed:
                now = time.monotonic()
                due = {kind: self._sent_at.get(kind, NEVER) + self._period(kind) for kind in self._waiting}
                ready = [kind for kind, at in due.items() if at <= now] if self._has_credit() else []
                if ready:
                    return self._send(min(ready, key=lambda kind: self._sent_at.get(kind, NEVER)), now)
                later = min(due.values(), default=NEVER) - now
                self._changed.wait(later if later > 0.0 and self._has_credit() else None)
            return None

    def acknowledge(self, number: int) -> tuple[str, float] | None:
        """The viewer has shown a message: its kind, and how long [s] after its birth; None for one nobody sent."""
        with self._changed:
            self._changed.notify()
            sent = self._on_the_way.pop(number, None)
        return (sent[0], time.monotonic() - sent[1]) if sent else None

    def close(self) -> None:
        """Nothing is sent any more."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def _period(self, kind: str) -> float:
        return self._periods.get(kind.partition(" ")[0], 0.0)

    def _has_credit(self) -> bool:
        return self._most is None or len(self._on_the_way) < self._most

    def _send(self, kind: str, now: float) -> Sent:
        waiting = self._waiting.pop(kind)
        self._sent_at[kind] = now
        self._number += 1
        if self._most is not None:
            self._on_the_way[self._number] = kind, waiting.born
        return Sent(self._number, waiting.make)
