"""The clock by which samples were recorded. It is a machine's own, which may have been set meanwhile."""

SECOND = 1_000_000_000  # [ns]
OUT_OF_ORDER = SECOND  # [ns] by which samples may be written in another order than they came
LONGEST = 60 * SECOND  # [ns] without a sample, beyond which the clock was set, or the recorder stood still


def was_set_back(before: int, now: int) -> bool:
    """Whether the clock was set back between two samples, which came at `before` and `now` [ns]."""
    return now < before - OUT_OF_ORDER


class Elapsed:
    """How long a recording has lasted. A clock that was set takes no time, back or ahead."""

    def __init__(self) -> None:
        self.longest = 0.0  # [s] of the time that was passed over
        self._passed = 0  # [ns]
        self._latest: int | None = None  # [ns]

    def at(self, received: int) -> float:
        """How long [s] when the next sample came, at `received` [ns] by the clock."""
        latest = received if self._latest is None else self._latest
        if received > latest + LONGEST:
            self.longest = max(self.longest, (received - latest) / SECOND)
            latest = received
        elif was_set_back(latest, received):
            latest = received
        self._passed += max(received - latest, 0)
        self._latest = max(received, latest)
        return self._passed / SECOND
