"""How fast work may come in: what comes faster waits, so that no flood takes a whole process."""


class Pace:
    """Lets `burst` things through at once, and `rate` [Hz] over time. Times [s] are the caller's, on any clock."""

    def __init__(self, rate: float, burst: int) -> None:
        self._interval = 1.0 / rate
        self._slack = burst * self._interval
        self._paid_until = 0.0

    def delay(self, now: float) -> float:
        """How long [s] the next thing has to wait; 0 where it may come now."""
        return max(0.0, self._paid_until + self._interval - self._slack - now)

    def spend(self, now: float) -> None:
        """A thing came through."""
        self._paid_until = max(self._paid_until, now) + self._interval

    def begin_anew(self) -> None:
        """Forget what came through, as where the caller's clock was set back."""
        self._paid_until = 0.0
