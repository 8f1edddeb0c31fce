"""All that is decided about a base of any make: its odometry, scans, commands and times in, velocities out.

It has no clock and no network. Steady times `now` are in seconds, stamps in nanoseconds since the epoch.
"""

import math

from cliffscan.common.contract.base_messages import BaseState, Odometry, SafetyState, Velocity
from cliffscan.safety.inputs import BaseReport, Contacts, Twist
from cliffscan.safety.message_gate import SILENT, MessageGate, Warn
from cliffscan.safety.rules import Decision
from cliffscan.safety.safety_reports import Reasons
from cliffscan.safety.scan_claims import AHEAD
from cliffscan.services.gate.config import GateConfig
from cliffscan.services.gate.odometry_track import WHEEL_SEPARATION, OdometryTrack

STATE_SILENT = 0.5  # [s] without base/state after which a base that published it is not driven
NO_ODOMETRY = "no odometry comes"
NO_STATE = "base/state has come before and comes no more"
NOTHING_FELT = Contacts()


class GateController:
    """A gate for a base that publishes its odometry. warn(count, why) is called with whatever is odd."""

    def __init__(self, config: GateConfig, warn: Warn) -> None:
        self._warn, self._simulated = warn, config.simulated
        limits = config.limits()
        self._gate = MessageGate(limits, WHEEL_SEPARATION, warn)
        self._track = OdometryTrack(limits)
        self._contacts, self._felt_at = NOTHING_FELT, math.inf  # [s], infinite while no state has come
        self._touched = NOTHING_FELT  # all that was felt since the last odometry
        self._outputs: list[Twist] = []
        self._odd = ""  # what is wrong with the odometry that comes
        self.describe, self.scan = self._gate.describe, self._gate.scan
        self.clear = self._gate.clear

    @property
    def decision(self) -> Decision:
        """The last one."""
        return self._gate.decision

    @property
    def alive_at(self) -> float:
        """[s] when the odometry last went on."""
        return self._gate.alive_at

    def take_outputs(self) -> list[Twist]:
        """What the base may do, for each decision since this was last asked."""
        outputs, self._outputs = self._outputs, []
        return outputs

    # ---- what comes

    def odometry(self, message: Odometry, stamp: int, now: float) -> None:
        """Where the base is. A message that is old, or of the future, is as if none came."""
        self._odd = _off("the odometry", message.stamp, stamp)
        if self._odd:
            self._warn("odometry_refused", self._odd)
            return
        if self._state_is_silent(now):
            return  # the track sees the gap when the state comes again, and begins anew
        step = self._track.update(message, now)
        if step is None:
            return
        self._gate.report(BaseReport(self._touched, *step), message.stamp, now)
        self._touched = self._contacts
        self._gate.caught_up()  # what is older than SILENT was refused
        self.decide(now)

    def state(self, message: BaseState, stamp: int, now: float) -> None:
        """What the base feels. All of it counts with the next odometry, and a state of another time not at all."""
        if odd := _off("base/state", message.stamp, stamp):
            self._warn("state_refused", odd)
            self._felt_at = min(self._felt_at, now)  # the base feels, even where what it felt is not known
            return
        self._felt_at = now
        before = self._touched
        self._contacts = Contacts(
            cliffs=message.cliffs,
            bumpers=message.bumpers,
            wheel_drops=message.wheel_drops,
            overcurrents=message.overcurrents,
            stop_button=message.buttons[0],
        )
        self._touched = before.joined(self._contacts)

    def command(self, message: Velocity, stamp: int, now: float) -> None:
        """Somebody wants the robot to move; decided with the next odometry, or now if it slows down."""
        if self._gate.command(message, stamp, now):
            self.decide(now)

    def stop(self, now: float) -> None:
        """The emergency stop."""
        self._gate.stop("asked to")
        self.decide(now)

    def tick(self, now: float) -> None:
        """Time passes: notice a silent base, and decide where no odometry asks for it."""
        if self._state_is_silent(now):
            self._gate.lose_base(NO_STATE)
        else:
            self._gate.notice_silence(now, self._odd or NO_ODOMETRY)
        if self._gate.due(now):
            self.decide(now)

    # ---- what is decided

    def decide(self, now: float) -> Decision:
        """Ask the gate what the base may do."""
        decision = self._gate.decide(now, self._gate.mismatch(self._simulated))
        self._outputs.append(decision.allowed)
        return decision

    def safety_state(self, stamp: int, now: float) -> SafetyState:
        """The last decision, as it is published."""
        return self._gate.state(stamp, now)

    def reasons(self, now: float) -> Reasons:
        """What of the last decision is news when it changes."""
        return self._gate.reasons(now)

    def _state_is_silent(self, now: float) -> bool:
        return now - self._felt_at > STATE_SILENT


def _off(what: str, stamp: int, clock: int) -> str:
    """Why a message of the base is not believed, by its stamp and our clock [ns], or nothing."""
    late = (clock - stamp) * 1e-9
    if -AHEAD <= late <= SILENT:
        return ""
    way = "behind" if late > 0.0 else "ahead of"
    return f"the stamp of {what} is {abs(late):.2f} s {way} this clock: synchronise the clocks"
