"""Which robots a process claims and serves, by what it knows of the others' tokens.

A robot passes from one process to another without two of them publishing: the first withdraws its tokens when it has
published its last scan, and the second begins when all of them have been away for SETTLED.
"""

from collections import defaultdict
from collections.abc import Collection, Mapping
from enum import Enum, auto

from cliffscan.common.contract.topics import WORKSTATION
from cliffscan.services.perception.shares import balanced, heaviest

CLAIM = "perception/"  # and the name of a process: its token for a robot that it serves, or would serve
PARTS = ("negative", "positive", "fuse", "perception")  # whose tokens are held by what serves a robot
SETTLED = 0.15  # [s] in which tokens that were declared at the same time have reached everybody
MOST = 64  # robots that a process of the fleet claims
REMEMBERED = 1024  # robots of which it is known that others served them
LEAVING = 1.0  # [s] in which what another process publishes may be the last of one that leaves the robot to this one
LYING = 5.0  # [s] for which a robot may lie with a member that claims none; it hangs, or no good image reaches it
YIELDED = 3.0  # [s] after the last status of another service in which a robot is left to it


class Standing(Enum):
    """What a process is for a robot."""

    AWAY = auto()
    CLAIMS = auto()  # it holds a claim, and serves when nobody else does, or stands by
    SERVES = auto()


class Standings:
    """What this process, by its name `me`, is for each robot. Times [s] are the caller's, on any clock.

    named: the robots that it was started for; None where it serves every one, as a member of the fleet.
    """

    def __init__(self, me: str, named: Collection[str] | None, now: float) -> None:
        self._me = me
        self._named = named
        self._began = now
        self._members: set[str] = set()
        self._idle: set[str] = set()  # members that let robots lie; no share is theirs until they claim one
        self._lying_since: dict[str, float] = {}  # robots that fell to another member and are not claimed
        self._claims: defaultdict[str, set[str]] = defaultdict(set)  # of others
        self._services: defaultdict[str, set[str]] = defaultdict(set)  # PARTS that are alive, ours too
        self._held: set[str] = set()  # robots that were served or claimed, of late
        self.beyond: set[str] = set()  # robots that fall to this process and are more than MOST
        self._of: dict[str, Standing] = {}
        self._free_since: dict[str, float] = {}
        self._served_since: dict[str, float] = {}
        self._heard: dict[str, float] = {}  # when another's status came that may be the last of one that leaves
        self._yielded: dict[str, float] = {}  # when a service that serves the robot alone last published its status

    def member(self, name: str, here: bool) -> None:
        """Another process of the fleet came or went."""
        if name != self._me:
            (self._members.add if here else self._members.discard)(name)
            self._idle.discard(name)

    def token(self, robot: str, service: str, here: bool) -> None:
        """A token below a robot's name came or went; those of this process count only as tokens of services."""
        kept, name = (self._services, service) if service in PARTS else (self._claims, service.removeprefix(CLAIM))
        if name == self._me or (service not in PARTS and not service.startswith(CLAIM)):
            return
        if here:
            self._idle.discard(name)
            kept[robot].add(name)
            if len(self._held) >= REMEMBERED:
                self._held.clear()
            self._held.add(robot)
        elif robot in kept:
            kept[robot].discard(name)
            if not kept[robot]:
                del kept[robot]

    def status(self, robot: str, now: float) -> bool:
        """Another process published its status as negative, positive or fuse of a robot; whether this one yields to it.

        Tokens of one name are one to those that hold it too, so who serves a robot learns of another from this alone.
        Where another member claims the robot, the status is that one's, and the claims decide. One that leaves the
        robot to this process may publish a last status, or some at a time, so then it takes a later one, too.
        """
        if self.of(robot) is not Standing.SERVES or self._claims.get(robot, set()) & self._members:
            return False
        yields = not self._may_leave(robot, now) or LEAVING / 2 <= now - self._heard.get(robot, now) <= YIELDED
        if yields:
            self._yielded[robot] = now
        elif now - self._heard.get(robot, -YIELDED) >= YIELDED:
            self._heard[robot] = now
        return yields

    def _may_leave(self, robot: str, now: float) -> bool:
        """Whether another process may be about to leave a robot to this one, or has just done so."""
        return bool(self._by_name(robot)) or now - self._served_since.get(robot, now) < LEAVING

    def of(self, robot: str) -> Standing:
        """What this process is for a robot."""
        return self._of.get(robot, Standing.AWAY)

    def is_new(self, robot: str) -> bool:
        """Whether nobody has served or claimed a robot: no scan of its newest image can have been published."""
        return robot not in self._held

    def forget(self, robot: str) -> None:
        """A robot has been silent: it is new when it comes back."""
        self._held.discard(robot)

    def review(self, robots: Collection[str], now: float) -> dict[str, Standing]:
        """What changes for which robot, of those that publish; from now on it is so."""
        if self._named is None and now - self._began < SETTLED:
            return {}  # others' claims may not have come yet
        ours = self._ours(robots, now)
        if self._named is None:
            room = MOST - len(ours & self._of.keys())
            self.beyond = set(sorted(ours - self._of.keys())[max(room, 0) :])
            ours -= self.beyond
        found = {robot: self._standing(robot, ours, now) for robot in {*ours, *(self._named or ()), *self._of}}
        changes = {robot: standing for robot, standing in found.items() if standing is not self.of(robot)}
        self._of = {robot: standing for robot, standing in found.items() if standing is not Standing.AWAY}
        self._served_since = {
            robot: self._served_since.get(robot, now) for robot in self._of if self.of(robot) is Standing.SERVES
        }
        self._heard = {robot: at for robot, at in self._heard.items() if robot in self._served_since}
        return changes

    def _ours(self, robots: Collection[str], now: float) -> set[str]:
        """The robots that fall to this process, whoever serves them now."""
        if self._named is not None:
            return {robot for robot in self._named if self._goes_first(robot, self._by_name(robot))}
        members = {self._me, *self._members} - self._idle
        holders = {robot: heaviest(robot, held) for robot, claims in self._claims.items() if (held := claims & members)}
        for robot in self._of:
            if self._goes_first(robot, self._claims.get(robot, set())):
                holders[robot] = self._me
        served = {robot for robot in robots if self._is_for_members(robot)}
        of_members = {robot: member for robot, member in holders.items() if self._is_for_members(robot)}
        shares = balanced(served, members, of_members)
        unclaimed = served - self._claims.keys() - self._of.keys() - self._services.keys()
        self._look_for_idle({robot: shares[robot] for robot in unclaimed}, now)
        return {robot for robot, member in shares.items() if member == self._me and robot in served}

    def _look_for_idle(self, unclaimed: Mapping[str, str], now: float) -> None:
        """Find members that leave robots lying. unclaimed: robots that nobody serves, and to whom they fall."""
        claiming = set().union(*self._claims.values())
        lying = {robot for robot, member in unclaimed.items() if member not in (self._me, *claiming)}
        self._lying_since = {robot: self._lying_since.get(robot, now) for robot in lying}
        self._idle |= {unclaimed[robot] for robot in lying if now - self._lying_since[robot] >= LYING}

    def _by_name(self, robot: str) -> set[str]:
        """The other processes that were started for a robot by its name."""
        return self._claims.get(robot, set()) - self._members

    def _goes_first(self, robot: str, others: Collection[str]) -> bool:
        return heaviest(robot, {self._me, *others}) == self._me

    def _is_for_members(self, robot: str) -> bool:
        """Whether a robot is served by the fleet; what works for a robot's own perception is always named."""
        return robot.rpartition("/")[2] != WORKSTATION and not self._by_name(robot)

    def _standing(self, robot: str, ours: Collection[str], now: float) -> Standing:
        before = self.of(robot)
        stands_by = Standing.CLAIMS if self._named is not None else Standing.AWAY
        yields = now - self._yielded.get(robot, -YIELDED) < YIELDED
        if robot not in ours or yields:
            self._free_since.pop(robot, None)
            return stands_by
        if before is Standing.SERVES:
            return before
        if robot in self._services or (robot in self._claims and before is Standing.AWAY and self._named is None):
            self._free_since.pop(robot, None)
            return stands_by
        settled = now - self._free_since.setdefault(robot, now) >= SETTLED
        return Standing.SERVES if settled and before is Standing.CLAIMS else Standing.CLAIMS
