"""Whether what a base reports can follow from what it reported before, by its clock and by ours."""

import math

LONGEST_INCREMENT = 0.5  # [s] of the base's clock; the path driven in more is anybody's guess
LONGEST_SILENCE = 1.0  # [s] of our clock, in which reports may have been lost
LEAD = 0.1  # [s] by which the base's clock may lead before anything was late: its stamps and our wake-ups jitter
BACKLOG = 0.5  # [s] after which a third is left of what a late report saved up: it comes soon or not at all
DRIFT = 0.05  # of a lead that is forgiven each second, so that jitter does not add up
SLACK = 0.02  # [s] by which the sensors' own times may differ from the reports'


class Discontinuity(ValueError):
    """Two reports do not belong to one motion; the text says why."""


class Contradiction(Discontinuity):
    """Two reports that no base can give one after the other, however late they come: one of them is wrong."""


class ClockLead:
    """How far the base's clock may run ahead of ours: as far as reports came late before, and a little.

    Reports come late, never early. So time of the base that passes faster than ours was saved up while ours passed
    alone, in a report that was late or in a backlog that is read at once. A lead that was not saved up is a lie, and
    with it any speed that is taken from that clock.
    """

    def __init__(self) -> None:
        self._saved = 0.0  # [s], negative where the base's clock leads

    def interrupted(self) -> None:
        """Nobody listened for a while: a backlog of reports may be read at once."""
        self._saved = LONGEST_SILENCE

    def passed(self, seconds: float, ours: float) -> None:
        """So much [s] passed by the base's clock and by ours. Raises Contradiction."""
        if self._saved > 0.0:
            self._saved *= math.exp(-ours / BACKLOG)
        else:
            self._saved = min(self._saved + DRIFT * ours, 0.0)
        self._saved = min(self._saved + ours - seconds, LONGEST_SILENCE)
        if self._saved < -LEAD:
            self._saved = 0.0
            raise Contradiction(f"the base's clock went on by {seconds:.3f} s within {ours:.3f} s of ours")
