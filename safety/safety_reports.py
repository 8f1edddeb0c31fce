"""When the gate's state is to be published: when another rule holds, and now and then."""

import math

from cliffscan.common.contract.base_messages import SafetyState

PERIOD = 1.0  # [s] between two reports of an unchanged rule


class SafetyReports:
    """Remembers what was published last."""

    def __init__(self) -> None:
        self._last: tuple[str, bool, str] | None = None
        self._at = -math.inf

    def due(self, state: SafetyState, now: float) -> bool:
        """Whether this state is to be published now [s]; it is then taken for published."""
        words = "".join(each for each in state.note if not each.isdigit())  # a distance that changes is nothing new
        new = (state.rule, state.latched, words)
        if new == self._last and now - self._at < PERIOD:
            return False
        self._last, self._at = new, now
        return True
