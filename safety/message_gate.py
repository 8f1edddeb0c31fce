"""The gate with what stands before it for a base of any make: messages and odometry in, decisions and notes out.

Steady times `now` are in seconds, stamps in nanoseconds since the epoch. Nothing here reads a clock.
"""

import math
from collections.abc import Callable
from string import digits

from cliffscan.common.contract.base_messages import SafetyState, Velocity
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety import scan_claims
from cliffscan.safety.command_arbiter import CommandArbiter
from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.inputs import REST, Contacts, SafetyLimits
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.pose_history import PoseHistory
from cliffscan.safety.rules import Decision
from cliffscan.safety.scan_claims import Scan

REMEMBERED = 1.0  # [s] for which a scan that was refused is reported
WITHOUT_DIGITS = str.maketrans("", "", digits)

Warn = Callable[[str, str], None]  # warn(count, why)


class MessageGate:
    """Judges commands and scans, puts scans where the robot was, and decides.

    Poses are of one odometry that never jumps. `warn` is called with whatever is odd.
    """

    def __init__(self, limits: SafetyLimits, warn: Warn) -> None:
        start = Pose2D(0.0, 0.0, 0.0)
        self._warn = warn
        self._gate = SafetyGate(limits, start)
        self._arbiter = CommandArbiter(limits.command_timeout, limits.stamp_tolerance)
        self._history = PoseHistory()
        self._scan_refused, self._scan_refused_at = "", -math.inf
        self.decision = Decision("no_base", REST, REST)
        # what a driver knows of its base goes to the gate as it is
        self.describe, self.lose_base = self._gate.describe, self._gate.lose_base
        self.stop, self.clear = self._gate.stop, self._gate.clear
        self.distrust, self.doubt = self._gate.distrust, self._gate.doubt

    @property
    def latched(self) -> bool:
        """Whether the robot stands still until clear()."""
        return bool(self._gate.stopped or self._gate.distrusted)

    def restart(self, pose: Pose2D) -> None:
        """Nobody knows what happened since the last report of the base; the robot is at `pose` now."""
        self._gate.restart(pose)
        self._arbiter.forget()

    def sense(self, contacts: Contacts, pose: Pose2D, stamp: int) -> None:
        """The base reported what it feels and where it is."""
        self._history.add(stamp, pose)
        self._gate.sense(contacts, pose)

    def command(self, message: Velocity, stamp: int, now: float) -> bool:
        """Somebody wants the robot to move; whether that slows it down, so that it is to be decided at once."""
        refusal = self._arbiter.offer(message, stamp, now)
        if refusal:
            self._warn("command_refused", refusal)
            return False
        asked, allowed = self._arbiter.newest.twist, self.decision.allowed
        return asked != allowed and all(_slows(*pair) for pair in zip(asked, allowed, strict=True))

    def scan(self, message: LaserScan, stamp: int, now: float) -> None:
        """A fused scan came."""
        refusal = scan_claims.refusal(message, stamp)
        if refusal:
            self._scan_refused, self._scan_refused_at = refusal, now
            self._warn("scan_refused", refusal)
            return
        pose = self._history.at(message.stamp)
        if pose is None:  # unless the history is full, the scan is older than the odometry, which has begun just now
            if self._history.full:
                self._warn("scan_unplaced", f"stamp {message.stamp}: not known where the robot was then")
            return
        self._gate.see(Scan.of(message, self._gate.view), pose, now - (stamp - message.stamp) * 1e-9, now)

    def decide(self, now: float, refusal: str = "") -> Decision:
        """What goes to the wheels; refusal: why the driver refuses the base, or nothing."""
        self.decision = self._gate.decide(self._arbiter.newest, now, refusal)
        return self.decision

    def state(self, stamp: int, now: float) -> SafetyState:
        """The last decision, as it is published."""
        decision = self.decision
        return SafetyState(
            stamp=stamp,
            rule=decision.rule,
            distance=decision.distance,
            asked=decision.asked,
            allowed=decision.allowed,
            latched=self.latched,
            note=self.note(now),
        )

    def reasons(self, now: float) -> tuple[str, bool, str]:
        """What of the last decision is news when it changes: rule, latch and note, but no distance in it."""
        return self.decision.rule, self.latched, self.note(now).translate(WITHOUT_DIGITS)

    def note(self, now: float) -> str:
        """What a person should know of the last decision."""
        decision = self.decision
        scan = self._scan_refused if now - self._scan_refused_at <= REMEMBERED else ""
        parts = [decision.note, str(decision.obstruction or ""), self._arbiter.note(now)]
        parts.append(f"a scan is refused: {scan}" if scan else "")
        return "; ".join(filter(None, parts))


def _slows(asked: float, allowed: float) -> bool:
    """Whether a speed is lower, or the same."""
    return asked * allowed >= 0.0 and abs(asked) <= abs(allowed)
