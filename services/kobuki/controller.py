"""All that is decided about the base: bytes, scans, commands and times go in, bytes and reports come out.

It has no port, no clock and no network. Steady times `now` are in seconds, stamps in nanoseconds since the epoch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import NamedTuple

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety import scan_claims
from cliffscan.safety.command_arbiter import CommandArbiter
from cliffscan.safety.gate import REST, Decision, Safety, Scan, Twist
from cliffscan.safety.local_grid import Pose
from cliffscan.safety.odometry_monitor import OdometryMonitor
from cliffscan.safety.pose_history import PoseHistory
from cliffscan.services.kobuki.command_handlers import Answer, GainsDesk, Reply, done, failed
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.kinematics import METRES_PER_TICK
from cliffscan.services.kobuki.odometry import Estimate, Odometry
from cliffscan.services.kobuki.peripherals import Outlets
from cliffscan.services.kobuki.port import PortLost
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.frames import FrameParser
from cliffscan.services.kobuki.protocol.handshake import Handshake
from cliffscan.services.kobuki.protocol.packets import Feedback, decode
from cliffscan.services.kobuki.protocol.sensors import Core
from cliffscan.services.kobuki.protocol.versions import has_gains

TICK = 0.03  # [s] between decisions when the base is silent; it is not while it sends its packet every 0.02 s
SILENT = 0.2  # [s] in which the base's clock stood still
REMEMBERED = 1.0  # [s] for which it is told that a scan was refused
BOTH_SIMULATED = "the camera is simulated and the base is real: set capture.source to the camera on the robot"


class Report(NamedTuple):
    """What a packet told."""

    feedback: Feedback
    core: Core
    estimate: Estimate
    stamp: int  # [ns]


class Output(NamedTuple):
    """Bytes for the base. Those of a stop go before all that waits."""

    data: bytes
    stop: bool = False


class BaseController:
    """The base's driver and its gate. warn(count, why) is told of whatever is odd."""

    def __init__(self, config: KobukiConfig, warn: Callable[[str, str], None]) -> None:
        self._config, self._warn = config, warn
        self._odometry = Odometry()  # for the world, which may reset it
        self._origin = Pose(0.0, 0.0, 0.0)  # where it was reset, in the gate's frame, which never jumps
        self._history = PoseHistory()
        self._safety = Safety(config, Pose(0.0, 0.0, 0.0))
        self._arbiter = CommandArbiter(config.command_timeout, config.stamp_tolerance)
        self._monitor = OdometryMonitor()
        self._outputs: list[Output] = []
        self._outlets, self._gains = Outlets(self._send), GainsDesk(self._send)
        self._camera: CameraDescription | None = None
        self._scan_refused, self._scan_refused_at = "", -math.inf
        self._decided_at = -math.inf
        self.decision = Decision("no_base", REST, REST)
        self.connected = self.simulated = False
        self._begin(-math.inf)

    def _begin(self, now: float) -> None:
        """Know nothing of the base."""
        self._parser, self._handshake = FrameParser(), Handshake()
        self._monitor.begin()
        self._catching_up = False  # with what the base said while nobody listened
        self._read: tuple[Core, float, float, float, float] | None = None  # core, clock, left, right, gyro unwrapped
        self.heard_at = now  # [s] when the base's clock last went on

    # ---- the line

    def connect(self, simulated: bool, now: float) -> None:
        """The port was opened; it leads to an emulated base or to a real one."""
        self._begin(now)
        self.connected, self.simulated = True, simulated

    def disconnect(self) -> None:
        """The port is gone."""
        self.connected = False
        self._outputs.clear()
        self._safety.lose_base()
        self._odometry.rebaseline("the port was opened anew")

    def take_outputs(self) -> list[Output]:
        """What is to be sent to the base since this was last asked."""
        outputs, self._outputs = self._outputs, []
        return outputs

    def caught_up(self) -> None:
        """All that the base said has been read."""
        self._catching_up = False

    @property
    def accepted(self) -> bool:
        """Whether the base may be driven, by its firmware."""
        return self.connected and self._handshake.accepted

    @property
    def refused(self) -> str:
        """Why nothing may be driven although the base is there, or nothing."""
        if self._handshake.refused:
            return self._handshake.refused
        simulated = self._camera is not None and self._camera.simulated
        return BOTH_SIMULATED if simulated and self.connected and not self.simulated else ""

    @property
    def latched(self) -> bool:
        """Whether the robot stands still until clear_safety."""
        return bool(self._safety.latched or self._safety.distrusted)

    # ---- what comes

    def receive(self, data: bytes, stamp: int, now: float) -> Iterator[Report]:
        """Take in what the base said; a report for each packet that told something new."""
        bad = self._parser.counts.bad_checksums
        for payload in self._parser.feed(data):
            report = self._packet(decode(payload), stamp, now)
            if report:
                yield report
        for _ in range(self._parser.counts.bad_checksums - bad):
            self._warn("bad_packet", "the base sent a packet with a wrong checksum")

    def command(self, message: Velocity, stamp: int, now: float) -> None:
        """Somebody wants the robot to move. It goes to the base with the next packet, or now if it slows down."""
        refusal = self._arbiter.offer(message, stamp, now)
        if refusal:
            self._warn("command_refused", refusal)
            return
        asked, allowed = Twist(message.linear, message.angular), self.decision.allowed
        self._safety.command(asked, now)
        if asked != allowed and all(_slows(*pair) for pair in zip(asked, allowed, strict=True)):
            self.decide(now)

    def scan(self, scan: LaserScan, stamp: int, now: float) -> None:
        """A fused scan came."""
        refusal = scan_claims.refusal(scan, stamp)
        if refusal:
            self._scan_refused, self._scan_refused_at = refusal, now
            self._warn("scan_refused", refusal)
            return
        pose = self._history.at(scan.stamp)
        if pose is None:  # unless the history is full, the scan is older than the odometry, which has begun just now
            if self._history.full:
                self._warn("scan_unplaced", f"stamp {scan.stamp}: not known where the robot was then")
            return
        self._safety.see(Scan.of(scan, self._safety.view), pose, now - (stamp - scan.stamp) * 1e-9, now)

    def describe(self, camera: CameraDescription) -> None:
        """The camera's service says what it sees."""
        self._camera = camera
        self._safety.describe(camera)

    def stop(self, now: float) -> None:
        """The emergency stop."""
        self._safety.stop("asked to")
        self.decide(now)

    def tick(self, now: float) -> None:
        """Time passes: notice a silent base, ask what it has not answered, decide where no packet asks for it."""
        if now - self.heard_at > SILENT:
            self._safety.lose_base("the base's clock stands still" if self.connected and self._read else "")
        if self._parser.counts.good and (request := self._handshake.request(now)):
            self._outputs.append(Output(request))
        if now - self._decided_at >= TICK:
            self.decide(now)

    # ---- what is decided

    def decide(self, now: float) -> Decision:
        """Ask the gate, and tell the wheels."""
        self._decided_at = now
        was_moving = self.decision.allowed != REST
        self.decision = self._safety.decide(now)
        if self.refused:
            self.decision = Decision("refused", REST, self.decision.asked, note=self.refused)
        if self.accepted:
            allowed = self.decision.allowed
            self._outputs.append(Output(commands.base_control(*allowed), stop=was_moving and allowed == REST))
            self._monitor.send(*allowed, now)
        return self.decision

    def note(self, now: float) -> str:
        """What a person should know of the last decision."""
        decision = self.decision
        scan = self._scan_refused if now - self._scan_refused_at <= REMEMBERED else ""
        parts = [decision.note, str(decision.obstruction or ""), self._arbiter.note(now)]
        parts.append(f"a scan is refused: {scan}" if scan else "")
        return "; ".join(filter(None, parts))

    # ---- what is asked for

    def requests(self) -> dict[str, Reply]:
        """What answers each request but stop."""
        return {
            "clear_safety": self._clear,
            "reset_odometry": self._reset,
            "led": self._outlets.led,
            "sound": self._outlets.sound,
            "digital_output": self._outlets.digital_output,
            "gains": self._ask_gains,
            "version": lambda _: self._handshake.told(),
        }

    def _clear(self, _: Answer) -> Answer:
        self._safety.clear()
        self._monitor.begin()
        return done("cleared")

    def _reset(self, _: Answer) -> Answer:
        self._origin = self._origin.then(Pose(*self._odometry.pose))
        self._odometry.reset()
        return done("here is the origin")

    def _ask_gains(self, parameters: Answer) -> Answer | Future[Answer]:
        firmware = self._handshake.firmware
        if firmware and not has_gains(firmware):
            return failed(f"firmware {firmware} has no gains to tell")
        return self._gains.request(parameters)

    def _send(self, data: bytes) -> None:
        if not self.accepted:
            raise PortLost("the base is not connected")
        self._outputs.append(Output(data))

    # ---- a packet

    def _packet(self, feedback: Feedback, stamp: int, now: float) -> Report | None:
        for skipped in feedback.skipped:
            self._warn("bad_sub_payload", str(skipped))
        if self._handshake.hear(feedback) and self._handshake.accepted:
            self._outlets.resend()
        if feedback.gains:
            self._gains.told(feedback.gains)
        core = feedback.core
        if core is None or not self._handshake.accepted or self._is_repeated(core):
            return None
        self.heard_at = now
        estimate = self._odometry.update(core, feedback.inertia, now)
        pose = self._origin.then(Pose(*estimate.pose))
        if estimate.new_baseline:
            self._warn("baseline", estimate.new_baseline)
            self._catching_up = True
        if self._catching_up:  # what is read late tells where the robot was; it begins anew where it is
            self._safety.restart(pose)
            self._monitor.begin()
        if estimate.contradiction:
            self._safety.doubt(f"the odometry contradicts itself: {estimate.new_baseline}", now)
        self._history.add(stamp, pose)
        self._safety.sense(core, pose)
        self._watch_wheels(feedback, core, now)
        self.decide(now)
        return Report(feedback, core, estimate, stamp)

    def _is_repeated(self, core: Core) -> bool:
        """Whether the base's clock has not gone on: then nothing in the packet is news."""
        return self._read is not None and core.timestamp == self._read[0].timestamp

    def _watch_wheels(self, feedback: Feedback, core: Core, now: float) -> None:
        angle = feedback.inertia.angle if feedback.inertia else math.nan
        if self._read is None or self._catching_up:
            self._read = (core, 0.0, 0.0, 0.0, angle)
            return
        before, clock, left, right, gyro = self._read
        clock += ((core.timestamp - before.timestamp) & 0xFFFF) / 1000.0
        left += _ticks(before.left_encoder, core.left_encoder) * METRES_PER_TICK
        right += _ticks(before.right_encoder, core.right_encoder) * METRES_PER_TICK
        if math.isnan(gyro):
            gyro = angle
        elif feedback.inertia:
            gyro += math.remainder(angle - gyro, math.tau)
        self._read = (core, clock, left, right, gyro)
        self._monitor.read(clock, left, right, None if math.isnan(gyro) else gyro)
        if stuck := self._monitor.stuck(now):
            self._safety.distrust(stuck)
        if wrong := self._monitor.contradicted() or self._monitor.runaway(now):
            self._safety.doubt(wrong, now)


def _slows(asked: float, allowed: float) -> bool:
    """Whether a speed is lower, or the same."""
    return asked * allowed >= 0.0 and abs(asked) <= abs(allowed)


def _ticks(before: int, after: int) -> int:
    return (after - before + 0x8000 & 0xFFFF) - 0x8000
