"""Which of several drivers' commands holds: one source at a time, and none whose stamp is far from our clock."""

import math
from typing import NamedTuple

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.safety.inputs import NO_COMMAND, Command, Twist

REMEMBERED = 1.0  # [s] for which a refusal is reported
LONGEST = 32  # characters of a source's name


class Holder(NamedTuple):
    """The source that drives, and its newest command."""

    command: Velocity
    at: float  # [s] when it came


class CommandArbiter:
    """Takes the commands of all sources, one after the other; those it refuses move nothing.

    A source keeps the wheels until it has been silent for `timeout` [s], or one of a higher priority comes. A command
    whose stamp is more than `tolerance` [s] from our clock is refused: after an outage old ones arrive in a burst, and
    two clocks that disagree are to be synchronised. Of one source only the newest counts.
    """

    def __init__(self, timeout: float, tolerance: float) -> None:
        self._timeout, self._tolerance = timeout, tolerance
        self._holder: Holder | None = None
        self.newest = NO_COMMAND  # what the source that drives asked for last
        self._refused, self._refused_at = "", -math.inf

    def offer(self, command: Velocity, stamp: int, now: float) -> str:
        """Take a command that came when our clocks said `stamp` [ns] and `now` [s]; why it is refused, or nothing."""
        refusal = self._refusal(command, stamp, now)
        if refusal:
            self._refused, self._refused_at = refusal, now
        else:
            self._holder = Holder(command, now)
            self.newest = Command(Twist(command.linear, command.angular), now)
        return refusal

    def forget(self) -> None:
        """What was asked for counts no longer; its source keeps the wheels."""
        self.newest = NO_COMMAND

    def note(self, now: float) -> str:
        """The last refusal, while it is recent."""
        return self._refused if now - self._refused_at <= REMEMBERED else ""

    def _refusal(self, command: Velocity, stamp: int, now: float) -> str:
        late = (stamp - command.stamp) * 1e-9
        if abs(late) > self._tolerance:
            way = "behind" if late > 0.0 else "ahead of"
            text = f"the stamp of {_name(command)} is {abs(late):.1f} s {way} this clock"
            return f"{text}: it moves nothing; synchronise the clocks"
        if self._holder is None or now - self._holder.at > self._timeout:
            return ""
        holder = self._holder.command
        if command.source == holder.source:
            return f"{_name(command)} was overtaken by a newer one" if command.stamp < holder.stamp else ""
        if command.priority > holder.priority:
            return ""
        return f"{_name(command)} is refused: {_name(holder)} drives with priority {holder.priority}"


def _name(command: Velocity) -> str:
    """The command's source for people: it may be anybody's text."""
    text = "".join(each for each in command.source[:LONGEST] if each.isprintable())
    return f"a command of {text!r}" if text else "a command without a source"
