"""When the gate's state is to be published: when another rule holds, and now and then."""

import math

PERIOD = 1.0  # [s] between two reports of an unchanged rule

Reasons = tuple[str, bool, str]  # MessageGate.reasons()


class SafetyReports:
    """Remembers what was published last."""

    def __init__(self) -> None:
        self._last: Reasons | None = None
        self._at = -math.inf

    def due(self, reasons: Reasons, now: float) -> bool:
        """Whether a state with these reasons is to be published now [s]; it is then taken for published."""
        if reasons == self._last and now - self._at < PERIOD:
            return False
        self._last, self._at = reasons, now
        return True
