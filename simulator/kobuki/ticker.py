"""Time in whole nanoseconds, so that no number of small steps ever loses or gains a packet."""

import math

SECOND = 1_000_000_000  # [ns]


class Ticker:
    """Something that happens again and again."""

    def __init__(self, period: int) -> None:
        self.left = period  # [ns] to the next time
        self._period = period

    def advance(self, ns: int) -> bool:
        """Let time pass, at most `left`. True where it has come to the next time."""
        self.left -= ns
        if self.left > 0:
            return False
        self.left = self._period
        return True


def nanoseconds(seconds: float) -> int:
    """A span of time [ns]. Raises ValueError for one that is negative or not finite."""
    if not 0.0 <= seconds < math.inf:
        raise ValueError(f"{seconds} s, expected a span of 0 s or more")
    return round(seconds * SECOND)
