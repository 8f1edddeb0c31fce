"""How many frames of each robot are taken, where more come than can be turned into scans that are still fresh.

Frames that wait make every scan late and none newer. So as many are taken as there is time for, each robot the same
time at most, and the others are dropped as they come, before they cost anything. Where all frames take as long, each
robot has the same number; one that sends large ones costs another nothing. Only a robot that sends frames before its
last ones are answered is limited.
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable
from typing import NamedTuple

PERIOD = 0.5  # [s] over which frames are counted
SMOOTH = 0.3  # share of the newest turns in what a frame costs
FULL = 0.9  # of the time that frames may take where not all are taken, lest they wait for one another


class Share(NamedTuple):
    """Frames [Hz] of one robot."""

    taken: float
    offered: float


def fair_limit(offered: Iterable[float], capacity: float) -> float:
    """The most that each may have so that all together have `capacity`; infinite where they ask for no more."""
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
        self._turns: Counter[str] = Counter()
        self._busy: defaultdict[str, float] = defaultdict(float)  # [s] since `_began`
        self._costs: dict[str, float] = {}  # [s] of a frame of each robot
        self._late: set[str] = set()  # robots of which a frame made room for a newer one since `_began`

    def takes(self, robot: str, is_idle: bool) -> bool:
        """A frame of a robot comes; whether it is to be taken, as every one is that meets an idle process."""
        self._offered[robot] += 1
        share = self.shares.get(robot)
        if share is None:
            return True
        credit = self._credit.get(robot, 0.0) + share.taken / share.offered
        taken = is_idle or credit >= 1.0
        self._credit[robot] = max(credit - taken, -1.0)
        return taken

    def overtaken(self, robot: str) -> None:
        """A frame of a robot made room for a newer one: without that, there has been time for all of its frames."""
        self._late.add(robot)

    def worked(self, robot: str, seconds: float) -> None:
        """A turn of a robot took so long."""
        self._turns[robot] += 1
        self._busy[robot] += seconds

    def review(self, now: float) -> bool:
        """Once in PERIOD, see how many frames there is time for; whether that was done."""
        span = now - self._began
        if span < PERIOD:
            return False
        newest, self._offered = self._offered, Counter()
        offered = dict(newest)  # to which takes() may still add, in another thread
        mean = sum(self._busy.values()) / max(self._turns.total(), 1)
        self._costs = {robot: self._cost(robot, mean) for robot in offered}
        self._began, self._turns, self._busy = now, Counter(), defaultdict(float)
        rates = {robot: count / span for robot, count in sorted(offered.items())}
        asked = {robot: rate * self._costs[robot] for robot, rate in rates.items()}  # of the time
        late, self._late = self._late | self.shares.keys(), set()
        is_full = sum(asked.values()) > (FULL if self.shares else 1.0)
        limit = fair_limit(asked.values(), FULL) if is_full else math.inf
        limited = [robot for robot in rates if robot in late and asked[robot] > limit]
        shares = {robot: Share(limit / self._costs[robot], rates[robot]) for robot in limited}
        spread = {robot: number / len(shares) for number, robot in enumerate(shares)}  # lest all come at once
        self._credit = spread | {robot: credit for robot, credit in self._credit.items() if robot in shares}
        self.shares = shares
        return True

    def _cost(self, robot: str, mean: float) -> float:
        """Time [s] that a frame of a robot takes, smoothed; `mean` before its first."""
        if not self._turns[robot]:
            return self._costs.get(robot, mean)
        newest = self._busy[robot] / self._turns[robot]
        return newest * SMOOTH + self._costs.get(robot, newest) * (1.0 - SMOOTH)
