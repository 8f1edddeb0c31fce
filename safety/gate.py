"""The gate between every command and the wheels.

It has no clock and no port: times [s] are arguments, on one clock that does not go back. What it lets pass is a
function of what it took in and of the time, and every doubt stops the robot.
"""

import math

from cliffscan.common.contract.description import CameraDescription
from cliffscan.safety import rules
from cliffscan.safety.approach_monitor import ApproachMonitor, Glance
from cliffscan.safety.contact_recovery import ContactRecovery
from cliffscan.safety.hull import Disc
from cliffscan.safety.inputs import NO_COMMAND, REST, Command, Contacts, SafetyLimits
from cliffscan.safety.local_grid import RollingGrid
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.rules import Decision, Situation
from cliffscan.safety.scan_claims import Scan, View
from cliffscan.safety.velocity_limiter import STILL, VelocityLimiter, room_to_turn
from cliffscan.safety.velocity_ramp import VelocityRamp

TURNED = 0.1  # [s] in which a robot turns so far that nobody knows its heading
DOUBTED = 1.0  # [s] for which an odometry that contradicted itself is not driven by


class SafetyGate:
    """What is known, and what follows from it for the wheels."""

    def __init__(self, limits: SafetyLimits, pose: Pose2D) -> None:
        self._limits, self._hull = limits, limits.hull()
        self._to_turn = room_to_turn(self._hull, limits.margin)
        self._recovery = ContactRecovery()
        self._grid = RollingGrid(pose, limits.start_free)
        self._limiter = VelocityLimiter(limits, self._grid)
        self._decided_at = -math.inf
        self._going = STILL  # when the base was last heard
        self._approach = ApproachMonitor()
        self.view = View.undescribed()  # what scans may claim to see
        self.stopped = ""  # why the emergency stop holds, or nothing
        self.distrusted = ""  # why the odometry is not believed until clear(), or nothing
        self._doubt, self._doubted_until = "", -math.inf
        self._put_down: Pose2D | None  # where, unless that is not known any more
        self.put_down(pose)

    def put_down(self, pose: Pose2D) -> None:
        """Somebody put the robot there, and takes care that there is floor within `start_free`."""
        self.restart(pose)
        self._put_down = pose
        self._grid.follow(pose, Disc(self._limits.start_free))

    def restart(self, pose: Pose2D, away: float = math.inf) -> None:
        """For `away` [s] nobody knew how the robot moved: it is taken to be where it was, and may have gone on.

        It stands on floor, and has room to turn. What was in its way may still be there, and nearer. Of what was free
        only that is which is free wherever the robot may be, and nothing where it may have turned or been carried.
        """
        if away < math.inf and (self._going.straight or away <= TURNED):
            for way in (self._going.forward, -self._going.backward):
                self._grid.smear(pose.theta, way * away)
        else:
            self._grid.doubt()
        self._grid.follow(pose, self._to_turn)
        self._going = STILL  # all that is accounted for
        self._limiter.rest()
        self._recovery.clear()
        self._approach.begin()
        self._pose = pose
        self._put_down = None
        self._contacts: Contacts | None = None
        self._silence = ""  # why the base is silent
        self._tilted, self._carried = False, False
        self._scan_taken = self._scan_came = -math.inf
        self._blind_until = self._decided_at  # [s]; a scan taken before is of a place that nobody knows
        self._before, self._decided_at = REST, -math.inf

    def describe(self, camera: CameraDescription) -> None:
        """What the camera can see. What was seen by another one is not where it was put."""
        before, self.view = self.view, View.of(camera)
        if self._scan_came > -math.inf and not self.view.same(before):
            self._grid.doubt()
            if self._put_down and math.dist(self._pose[:2], self._put_down[:2]) < self._limits.start_free:
                self._grid.follow(self._put_down, Disc(self._limits.start_free))
            self._grid.follow(self._pose, self._to_turn)

    def lose_base(self, why: str = "") -> None:
        """The base has fallen silent."""
        self._contacts, self._silence = None, why

    def stop(self, why: str) -> None:
        """The emergency stop; it holds until clear()."""
        self.stopped = why

    def distrust(self, why: str) -> None:
        """The odometry is wrong; the robot stands still until clear()."""
        self.distrusted = self.distrusted or why

    def doubt(self, why: str, now: float) -> None:
        """The odometry may have been wrong for a moment; the robot stands still for as long as it takes to judge."""
        self._doubt, self._doubted_until = why, now + DOUBTED

    def clear(self) -> None:
        """Let go of the emergency stop, of a distrusted odometry, and of what bumpers and cliff sensors touched."""
        self.stopped = self.distrusted = ""
        self._approach.begin()
        self._recovery.clear()
        self._grid.forgive()

    def see(self, scan: Scan, pose: Pose2D, taken: float, now: float) -> None:
        """A fused scan came, taken at `taken` [s] by a robot at `pose`.

        One that was overtaken frees nothing, for what it shows may have changed, but what it shows in the way counts:
        no scan that claims to be of the future keeps an honest one out. One taken with a wheel in the air is of no use.
        """
        taken = min(taken, now)
        if self._tilted or taken <= self._blind_until:
            return
        camera = pose.then(self.view.camera)
        if taken < self._scan_taken:
            self._grid.mark(scan.ranges, scan.edges, scan.angles, camera)
            return
        self._scan_taken, self._scan_came = taken, now
        self._grid.see(*scan, camera, self.view.floor)
        if wrong := self._approach.see(Glance(scan.ranges, scan.angles, camera, taken)):
            self.distrust(wrong)

    def sense(self, contacts: Contacts, pose: Pose2D) -> None:
        """The base reported what it feels, and the robot is at `pose` now."""
        self._contacts, self._pose = contacts, pose
        self._grid.follow(pose, self._hull)
        if contacts.stop_button:
            self.stop("the stop button")

    def decide(self, command: Command, now: float, refusal: str = "", late: float = 0.0) -> Decision:
        """What goes to the wheels at `now` of the newest command; refusal: why the driver refuses the base.

        late: by how much [s] the base's report is older than it should be.

        To be asked at every report of the base and at every command. A command that is no number asks for nothing.
        """
        command = command if all(map(math.isfinite, command.twist)) else NO_COMMAND
        decision = rules.decide(self._situation(command, now, refusal, late))
        self._before, self._decided_at = decision.allowed, now
        self._limiter.send(decision.allowed, now)
        if self._contacts is not None:
            self._going = self._limiter.going(now)
        return decision

    def _situation(self, command: Command, now: float, refusal: str, late: float) -> Situation:
        """All that a decision follows from, once the latest contacts are taken in."""
        reaction = None
        if self._contacts is not None:
            self._notice_lifting(self._contacts, now)
            reaction = self._recovery.update(self._contacts, self._pose)
        return Situation(
            now=now,
            command=command,
            limits=self._limits,
            pose=self._pose,
            contacts=self._contacts,
            silence=self._silence,
            refusal=refusal,
            stopped=self.stopped,
            distrust=self.distrusted,
            doubt=self._doubt if now < self._doubted_until else None,
            reaction=reaction,
            late=late,
            scan_age=max(now - min(self._scan_taken, self._scan_came), 0.0),
            ramp=VelocityRamp(self._limits, self._before, now - self._decided_at),
            limiter=self._limiter,
            grid=self._grid,
            recovery=self._recovery,
        )

    def _notice_lifting(self, contacts: Contacts, now: float) -> None:
        """With one wheel in the air the camera is tilted; with both the robot is carried to where nobody knows."""
        self._carried |= all(contacts.wheel_drops)
        if self._tilted and not any(contacts.wheel_drops):
            self._blind_until = now
            if self._carried:
                self._put_down = None
                self._grid.forget()
                self._grid.follow(self._pose, self._to_turn)
            self._carried = False
        self._tilted = any(contacts.wheel_drops)
