"""The gate with what stands before it for a base of any make: messages and reports in, decisions and notes out.

Steady times `now` are in seconds, stamps in nanoseconds since the epoch. Nothing here reads a clock.
"""

import math
from collections.abc import Callable
from string import digits

from cliffscan.common.contract.base_messages import SafetyState, Velocity
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety import scan_claims
from cliffscan.safety.command_arbiter import CommandArbiter
from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.inputs import REST, BaseReport, SafetyLimits
from cliffscan.safety.odometry_monitor import OdometryMonitor
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.pose_history import PoseHistory
from cliffscan.safety.rules import Decision
from cliffscan.safety.safety_reports import Reasons
from cliffscan.safety.scan_claims import Scan

CARRIED = 5.0  # [s] of a silent base after which somebody may have carried it
REMEMBERED = 1.0  # [s] for which a scan that was refused is reported
TICK = 0.03  # [s] between decisions while the base is silent; else one follows each of its reports
SILENT = 0.2  # [s] without a new report after which the base is taken for silent
BOTH_SIMULATED = "the camera is simulated and the base is real: set capture.source to the camera on the robot"
WITHOUT_DIGITS = str.maketrans("", "", digits)

Warn = Callable[[str, str], None]  # warn(count, why)


class MessageGate:
    """Judges commands, scans and the base's reports, puts scans where the robot was, and decides.

    wheel_separation: [m] between the points whose ways a report has. `warn` is called with whatever is odd.
    """

    def __init__(self, limits: SafetyLimits, wheel_separation: float, warn: Warn) -> None:
        start = Pose2D(0.0, 0.0, 0.0)
        self._warn = warn
        self._gate = SafetyGate(limits, start)
        self._arbiter = CommandArbiter(limits.command_timeout, limits.stamp_tolerance)
        self._history = PoseHistory()
        self._monitor = OdometryMonitor(wheel_separation)
        self._scan_refused, self._scan_refused_at = "", -math.inf
        self._camera: CameraDescription | None = None
        self._decided_at = -math.inf
        self.decision = Decision("no_base", REST, REST)
        self.stop = self._gate.stop
        self._placed = False  # whether the base has reported since somebody put it down
        self._reported_at = -math.inf  # [s]
        self.begin(-math.inf)

    @property
    def latched(self) -> bool:
        """Whether the robot stands still until clear()."""
        return bool(self._gate.stopped or self._gate.distrusted)

    # ---- the base

    def begin(self, now: float) -> None:
        """Know nothing of the base, which may report from now on."""
        self._monitor.begin()
        self._reported = False
        self.catching_up = False  # with what the base sent while nobody read it
        self.alive_at = now  # [s] when it last reported something new

    def report(self, report: BaseReport, stamp: int, now: float) -> None:
        """The base reported something new, at `stamp` [ns]. To be followed by decide()."""
        silence, self._reported_at = now - self._reported_at, now
        self.alive_at, self._reported = now, True
        if report.new_baseline:
            self._warn("baseline", report.new_baseline)
            self.catching_up = True
        if self.catching_up:  # what is read late is of where the robot was; it begins anew where it is
            if self._placed:
                self._gate.restart(report.pose, report.unmeasured if silence <= CARRIED else math.inf)
            else:
                self._gate.put_down(report.pose)
            self._arbiter.forget()
            self._monitor.begin()
        if report.contradiction:
            self._gate.doubt(f"the odometry contradicts itself: {report.new_baseline}", now)
        self._history.add(stamp, report.pose)
        self._gate.sense(report.contacts, report.pose)
        if report.motion:
            self._monitor.read(*report.motion)
            if stuck := self._monitor.stuck(now):
                self._gate.distrust(stuck)
            if wrong := self._monitor.contradicted() or self._monitor.runaway(now):
                self._gate.doubt(wrong, now)

    def caught_up(self) -> None:
        """All that the base sent has been read."""
        self.catching_up = False
        self._placed |= self._reported

    def lose_base(self, why: str = "") -> None:
        """The base has fallen silent."""
        self._gate.lose_base(why)

    def notice_silence(self, now: float, why: str) -> None:
        """Time passes; why: what it means for this base where no new report comes any more."""
        if now - self.alive_at > SILENT:
            self._gate.lose_base(why if self._reported else "")

    # ---- what comes for it

    def describe(self, camera: CameraDescription) -> None:
        """What the camera sees, and where it stands."""
        self._camera = camera
        self._gate.describe(camera)

    def clear(self) -> None:
        """Let go of all that holds until somebody says that it may."""
        self._gate.clear()
        self._monitor.begin()

    def mismatch(self, simulated: bool) -> str:
        """Why a base, simulated or real, must not drive by this camera, or nothing."""
        return BOTH_SIMULATED if self._camera is not None and self._camera.simulated and not simulated else ""

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

    # ---- what is decided

    def due(self, now: float) -> bool:
        """Whether the next decision cannot wait for a report."""
        return now - self._decided_at >= TICK

    def decide(self, now: float, refusal: str = "", driven: bool = True) -> Decision:
        """What goes to the wheels; refusal: why the driver refuses the base, or nothing; driven: whether it obeys."""
        self._decided_at = now
        late = min(max(now - self.alive_at - TICK, 0.0), SILENT)
        self.decision = self._gate.decide(self._arbiter.newest, now, refusal, late)
        if driven:
            self._monitor.send(*self.decision.allowed, now)
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

    def reasons(self, now: float) -> Reasons:
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
