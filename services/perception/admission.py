"""How many frames of each robot are taken, where more come than can be turned into scans that are still fresh.

Frames that wait make every scan late and none newer. So as many are taken as there is time for, each robot the same
number at most, and the others are dropped as they come, before they cost anything.
"""

import math
from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

PERIOD = 0.5  # [s] over which frames are counted
FULL = 0.9  # of the time that frames may take where not all are taken, lest they wait for one another


class Share(NamedTuple):
    """Frames [Hz] of one robot."""

    taken: float
    offered: float


def fair_limit(offered: Iterable[float], capacity: float) -> float:
    """The most [Hz] that each may have so that all together have `capacity`; infinite where they ask for no more."""
    left, limit = capacity, math.inf
    rates = sorted(offered)
    for number, rate in enumerate(rates):
        limit = left / (len(rates) - number)
        if rate > limit:
            return limit
        left -= rate
    return math.inf


class Admission:
    """Times [s] are the caller's, on any clock that does not go back."""

    def __init__(self, now: float) -> None:
        self.shares: dict[str, Share] = {}  # of the robots of which not all frames are taken
        self._credit: dict[str, float] = {}  # frames that such a robot has saved up
        self._began = now
        self._offered: Counter[str] = Counter()
        self._turns, self._busy = 0, 0.0  # since `_began`

    def takes(self, robot: str) -> bool:
        """A frame of a robot comes; whether it is to be taken."""
        self._offered[robot] += 1
        share = self.shares.get(robot)
        if share is None:
            return True
        credit = self._credit[robot] + share.taken / share.offered
        taken = credit >= 1.0
        self._credit[robot] = credit - taken
        return taken

    def worked(self, seconds: float) -> None:
        """A turn of a robot took so long."""
        self._turns += 1
        self._busy += seconds

    def review(self, now: float) -> bool:
        """Once in PERIOD, see how many frames there is time for; whether that was done."""
        span = now - self._began
        if span < PERIOD:
            return False
        offered, self._offered = self._offered, Counter()
        turns, busy = self._turns, self._busy
        self._began, self._turns, self._busy = now, 0, 0.0
        rates = {robot: count / span for robot, count in offered.items()}
        capacity = turns / busy if busy else math.inf
        is_full = sum(rates.values()) > (FULL if self.shares else 1.0) * capacity
        limit = fair_limit(rates.values(), FULL * capacity) if is_full else math.inf
        shares = {robot: Share(limit, rate) for robot, rate in sorted(rates.items()) if rate > limit}
        spread = {robot: number / len(shares) for number, robot in enumerate(shares)}  # lest all come at once
        self._credit = spread | {robot: credit for robot, credit in self._credit.items() if robot in shares}
        self.shares = shares
        return True
