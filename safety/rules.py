"""The gate's rules, in order of strength: the first that holds decides what goes to the wheels."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from cliffscan.common.contract.base_messages import Rule as Name
from cliffscan.safety.contact_recovery import ContactRecovery, Kind, Reaction, touched
from cliffscan.safety.inputs import REST, Command, Contacts, SafetyLimits, Twist
from cliffscan.safety.local_grid import RollingGrid
from cliffscan.safety.pending_motion import SLOW, SLOW_TURN
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.velocity_limiter import Obstruction, SpeedLimit, VelocityLimiter
from cliffscan.safety.velocity_ramp import VelocityRamp

CRAWL = 0.02  # [m/s] below which a robot that is held back turns on the spot
NOTHING = -1.0  # [m] where no obstacle holds the robot back


class Decision(NamedTuple):
    """What goes to the wheels, and why."""

    rule: Name
    allowed: Twist
    asked: Twist
    distance: float = NOTHING  # [m] the robot can go
    note: str = ""
    obstruction: Obstruction | None = None


@dataclass(frozen=True)
class Situation:
    """All that a decision follows from. A text says why a rule holds; it is empty, or None, where it does not."""

    now: float  # [s]
    command: Command
    limits: SafetyLimits
    pose: Pose2D
    contacts: Contacts | None  # None while the base is silent
    silence: str
    refusal: str
    stopped: str
    distrust: str  # of the odometry, until somebody clears it
    doubt: str | None  # of the odometry, for a moment
    reaction: Reaction | None
    late: float  # [s] by which the pose is older than it should be
    scan_age: float  # [s], infinite before the first
    ramp: VelocityRamp
    limiter: VelocityLimiter
    grid: RollingGrid
    recovery: ContactRecovery

    @property
    def asked(self) -> Twist:
        """The velocity that is asked for."""
        return self.command.twist

    @cached_property
    def wanted(self) -> Twist:
        """What the speed limits and the accelerations leave of it."""
        return self.ramp.toward(self.ramp.limited(self.asked))

    @property
    def fresh_age(self) -> float | None:
        """How old [s] the last scan is, where it is fresh."""
        return self.scan_age if self.scan_age <= self.limits.scan_timeout else None

    def rest(self, rule: Name, note: str = "", distance: float = NOTHING) -> Decision:
        """The robot stands."""
        return Decision(rule, REST, self.asked, distance, note)

    def limit(self, side: int, wanted: Twist, age: float | None) -> SpeedLimit:
        """What is left of a velocity by what is ahead (side 1) or behind (-1), by a scan `age` [s] old or by none."""
        return self.limiter.limit(side, wanted, self.pose, age, self.late, self.now)

    def limit_turn(self, wanted: Twist, age: float | None) -> SpeedLimit:
        """What is left of a turn on the spot by what its corners would sweep."""
        return self.limiter.limit_turn(wanted, self.pose, age, self.late, self.now)

    @property
    def turn(self) -> Twist:
        """The turn on the spot that is asked for, by what the base may do."""
        return Twist(0.0, self.ramp.limited(self.asked).angular)

    def turn_on_the_spot(self, angular: float, age: float | None) -> Twist:
        """The robot turns, as far as nothing is in the way of its corners."""
        turn = self.ramp.toward(Twist(0.0, angular))
        return turn.scaled(self.limit_turn(turn, age).factor)

    def go_straight(self, linear: float, age: float | None) -> Twist:
        """The robot goes straight, as far as nothing is in the way."""
        straight = self.ramp.toward(Twist(linear, 0.0))
        return straight.scaled(min(self.limit(side, straight, age).factor for side in (1, -1)))

    @property
    def makes_room(self) -> bool:
        """Whether it goes straight so that it can turn; as it does, it goes on until the turn is free as asked for."""
        linear, angular = self.ramp.before
        return not self.limiter.hull.turns_free and 0.0 < abs(linear) <= SLOW and angular == 0.0

    def turn_aside(self) -> Twist:
        """The robot turns on the spot or, where its corners have no room for that, goes straight until they do.

        It goes at SLOW, and the way that it was asked to drive; asked for a turn alone it stands.
        """
        turn, linear = self.turn_on_the_spot(self.turn.angular, self.fresh_age), self.asked.linear
        if self.limiter.hull.turns_free or abs(linear) < CRAWL:
            return turn
        ample = not self.makes_room or self.limit_turn(self.turn, self.fresh_age).factor >= 1.0
        if ample and abs(turn.angular) >= SLOW_TURN:
            return turn
        return self.go_straight(math.copysign(min(abs(linear), SLOW), linear), self.fresh_age)


def refused(it: Situation) -> Decision | None:
    """The driver does not accept the base."""
    return it.rest("refused", it.refusal) if it.refusal else None


def no_base(it: Situation) -> Decision | None:
    """The base is silent."""
    return it.rest("no_base", it.silence) if it.contacts is None else None


def stopped(it: Situation) -> Decision | None:
    """The emergency stop holds."""
    return it.rest("stopped", it.stopped) if it.stopped else None


def wheel_drop(it: Situation) -> Decision | None:
    """A wheel hangs in the air."""
    return it.rest("wheel_drop") if it.contacts and any(it.contacts.wheel_drops) else None


def overcurrent(it: Situation) -> Decision | None:
    """A motor draws too much."""
    return it.rest("overcurrent") if it.contacts and any(it.contacts.overcurrents) else None


def distrusted_odometry(it: Situation) -> Decision | None:
    """The odometry is wrong."""
    return it.rest("odometry", f"{it.distrust}; holds until clear_safety") if it.distrust else None


def doubted_odometry(it: Situation) -> Decision | None:
    """The odometry contradicted itself a moment ago."""
    return it.rest("odometry", it.doubt) if it.doubt is not None else None


def cliff(it: Situation) -> Decision | None:
    """A cliff sensor fired."""
    return _back_off(it, "cliff")


def bumper(it: Situation) -> Decision | None:
    """A bumper fired."""
    return _back_off(it, "bumper")


def no_command(it: Situation) -> Decision | None:
    """Nobody drives."""
    return it.rest("no_command") if it.now - it.command.at > it.limits.command_timeout else None


def no_scan(it: Situation) -> Decision | None:
    """The robot does not see: it stops on its arc, and then may turn slowly."""
    if not it.limits.require_scan or it.fresh_age is not None:
        return None
    note = f"last scan {it.scan_age:.1f} s old" if it.scan_age < math.inf else "no scan yet"
    slow = it.limits.slow_turn
    turn = min(max(it.asked.angular, -slow), slow)
    allowed = it.turn_on_the_spot(turn, it.limits.scan_timeout) if it.limiter.stands(it.now) else REST
    return Decision("no_scan", allowed, it.asked, note=note)


def obstacle(it: Situation) -> Decision | None:
    """Something is in the way: so fast that the robot can brake before it touches anything.

    A robot that can hardly go on turns on the spot: a disc touches nothing new by that; what others sweep is looked at.
    One that may not turn either goes straight until it may.
    """
    limits = [it.limit(side, it.wanted, it.fresh_age) for side in (1, -1)]
    limits.append(it.limit_turn(it.turn if it.makes_room else it.wanted, it.fresh_age))
    factor = min(limit.factor for limit in limits)
    if factor >= 1.0:
        return None
    slower = it.wanted.scaled(factor)
    if abs(slower.linear) < CRAWL and it.limiter.stands(it.now):
        slower = it.turn_aside()
    nearest = min(limits, key=lambda limit: limit.distance)
    return Decision("obstacle", slower, it.asked, nearest.distance, obstruction=nearest.obstruction)


def limit(it: Situation) -> Decision | None:
    """More was asked for than the base may do."""
    return Decision("limit", it.wanted, it.asked) if it.wanted != it.asked else None


def free(it: Situation) -> Decision:
    """Nothing holds the robot back."""
    return Decision("free", it.wanted, it.asked)


def _back_off(it: Situation, kind: Kind) -> Decision | None:
    """What a sensor of this kind makes the robot do, as far as nothing is remembered behind it."""
    if it.reaction is None or it.reaction.hit.kind != kind:
        return None
    hit, linear, angular, note, pressed = it.reaction
    if pressed:
        it.grid.touch(touched(hit, it.pose, it.limiter.hull))
    if linear < 0.0:
        behind = it.limit(-1, Twist(linear, angular), None)
        linear *= behind.factor
        if -linear < CRAWL:  # the robot stays until it is let go, and then has backed off far enough
            if pressed:
                return it.rest(kind, "something is behind", behind.distance)
            it.recovery.clear()
            return None
    angular *= it.limit_turn(Twist(linear, angular), None).factor
    return Decision(kind, Twist(linear, angular), it.asked, note=note)


class Rule(NamedTuple):
    """A rule: when it holds and what it does, for people, and what it decides."""

    name: Name
    holds: str
    does: str
    decide: Callable[[Situation], Decision | None]


RULES = (
    Rule(
        "refused",
        "the driver refuses the base: its firmware is of another major version, or it is real and the camera simulated",
        "nothing is driven",
        refused,
    ),
    Rule("no_base", "the base is silent, or its clock stands still", "stands", no_base),
    Rule(
        "stopped",
        "the emergency stop was asked for, or its button on the base was pressed",
        "stands until `clear_safety`",
        stopped,
    ),
    Rule("wheel_drop", "a wheel hangs in the air", "stands until it is released", wheel_drop),
    Rule("overcurrent", "a motor draws too much", "stands until it is released", overcurrent),
    Rule(
        "odometry",
        "a wheel was commanded to turn and stands, or what is seen comes nearer much faster than the odometry says",
        "stands until `clear_safety`",
        distrusted_odometry,
    ),
    Rule(
        "odometry",
        "the wheels contradict the gyro or the command, or the base's clock contradicts ours",
        "stands for a second",
        doubted_odometry,
    ),
    Rule(
        "cliff",
        "a cliff sensor sees no floor",
        "backs off, turning away, until it is released and 5 cm farther, and then keeps away from that place; another "
        "cliff or a wheel drop on the way back stops it",
        cliff,
    ),
    Rule("bumper", "a bumper is pressed", "the same", bumper),
    Rule("no_command", "no command came for `command_timeout`", "stands", no_command),
    Rule(
        "no_scan",
        "the last scan that could be of this camera and of now is older than `scan_timeout`, or came longer ago",
        "stops on its arc, then only turns, at `slow_turn` at most",
        no_scan,
    ),
    Rule(
        "obstacle",
        "an obstacle, an edge or floor that was never seen is on the commanded arc",
        "drives only so fast that it can brake before it; a `footprint` that has no room for the turn asked for goes "
        "straight until it has",
        obstacle,
    ),
    Rule(
        "limit",
        "more was asked for than `max_linear`, `max_angular` or an acceleration allow",
        "drives the same arc, slower",
        limit,
    ),
    Rule("free", "nothing else holds", "drives as commanded", free),
)


def decide(it: Situation) -> Decision:
    """What the strongest rule that holds makes of the command."""
    return next(decision for rule in RULES if (decision := rule.decide(it)))
