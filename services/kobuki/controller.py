"""All that is decided about the base: bytes, scans, commands and times go in, bytes and reports come out.

It has no port, no clock and no network. Steady times `now` are in seconds, stamps in nanoseconds since the epoch.
"""

import math
from collections.abc import Iterator
from concurrent.futures import Future
from typing import NamedTuple

from cliffscan.common.contract.base_messages import SafetyState, Velocity
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.runtime.command_handlers import Answer, Reply, done, failed
from cliffscan.safety.inputs import REST, BaseReport, Motion
from cliffscan.safety.message_gate import MessageGate, Warn
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.rules import Decision
from cliffscan.safety.safety_reports import Reasons
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.contacts import contacts
from cliffscan.services.kobuki.gains import GainsHandler
from cliffscan.services.kobuki.kinematics import METRES_PER_TICK, WHEEL_SEPARATION
from cliffscan.services.kobuki.odometry import Estimate, Odometry
from cliffscan.services.kobuki.peripherals import Peripherals
from cliffscan.services.kobuki.port import PortLost
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.kobuki.protocol.frames import FrameParser
from cliffscan.services.kobuki.protocol.handshake import Handshake
from cliffscan.services.kobuki.protocol.packets import Feedback, decode
from cliffscan.services.kobuki.protocol.sensors import Core
from cliffscan.services.kobuki.protocol.versions import has_gains

STANDS_STILL = "the base's clock stands still"


class Report(NamedTuple):
    """What a packet brought."""

    feedback: Feedback
    core: Core
    estimate: Estimate
    stamp: int  # [ns]


class Output(NamedTuple):
    """Bytes for the base. Those of a stop go before all that waits."""

    data: bytes
    stop: bool = False


class BaseController:
    """The base's driver on its gate. warn(count, why) is called with whatever is odd."""

    def __init__(self, config: KobukiConfig, warn: Warn) -> None:
        self._warn = warn
        self._odometry = Odometry()  # for the world, which may reset it
        self._origin = Pose2D(0.0, 0.0, 0.0)  # where it was reset, in the gate's frame, which never jumps
        self._gate = MessageGate(config.limits(), WHEEL_SEPARATION, warn)
        self._outputs: list[Output] = []
        self._peripherals, self._gains = Peripherals(self._send), GainsHandler(self._send)
        self.connected = self.simulated = False
        self._begin(-math.inf)

    def _begin(self, now: float) -> None:
        """Know nothing of the base."""
        self._parser, self._handshake = FrameParser(), Handshake()
        self._gate.begin(now)
        self._read: tuple[Core, Motion] | None = None

    # ---- the line

    def connect(self, simulated: bool, now: float) -> None:
        """The port was opened; it leads to an emulated base or to a real one."""
        self._begin(now)
        self.connected, self.simulated = True, simulated

    def disconnect(self) -> None:
        """The port is gone."""
        self.connected = False
        self._outputs.clear()
        self._gate.lose_base()
        self._odometry.rebaseline("the port was opened anew")

    def take_outputs(self) -> list[Output]:
        """What is to be sent to the base since this was last asked."""
        outputs, self._outputs = self._outputs, []
        return outputs

    def caught_up(self) -> None:
        """All that the base sent has been read."""
        self._gate.caught_up()

    @property
    def catching_up(self) -> bool:
        """Whether what was read since caught_up() came late."""
        return self._gate.catching_up

    @property
    def alive_at(self) -> float:
        """[s] when the base's clock last went on."""
        return self._gate.alive_at

    @property
    def accepted(self) -> bool:
        """Whether the base may be driven, by its firmware."""
        return self.connected and self._handshake.accepted

    @property
    def refused(self) -> str:
        """Why nothing may be driven although the base is there, or nothing."""
        return self._handshake.refused or (self._gate.mismatch(self.simulated) if self.connected else "")

    @property
    def decision(self) -> Decision:
        """The last one."""
        return self._gate.decision

    # ---- what comes

    def receive(self, data: bytes, stamp: int, now: float) -> Iterator[Report]:
        """Take in what the base sent; a report for each packet that brought something new."""
        bad = self._parser.counts.bad_checksums
        for payload in self._parser.feed(data):
            report = self._packet(decode(payload), stamp, now)
            if report:
                yield report
        for _ in range(self._parser.counts.bad_checksums - bad):
            self._warn("bad_packet", "the base sent a packet with a wrong checksum")

    def command(self, message: Velocity, stamp: int, now: float) -> None:
        """Somebody wants the robot to move. It goes to the base with the next packet, or now if it slows down."""
        if self._gate.command(message, stamp, now):
            self.decide(now)

    def scan(self, scan: LaserScan, stamp: int, now: float) -> None:
        """A fused scan came."""
        self._gate.scan(scan, stamp, now)

    def describe(self, camera: CameraDescription) -> None:
        """What the camera sees, and where it stands."""
        self._gate.describe(camera)

    def stop(self, now: float) -> None:
        """The emergency stop."""
        self._gate.stop("asked to")
        self.decide(now)

    def tick(self, now: float) -> None:
        """Time passes: notice a silent base, ask what it has not answered, decide where no packet asks for it."""
        self._gate.notice_silence(now, STANDS_STILL if self.connected else "")
        if self._parser.counts.good and (request := self._handshake.request(now)):
            self._outputs.append(Output(request))
        if self._gate.due(now):
            self.decide(now)

    # ---- what is decided

    def decide(self, now: float) -> Decision:
        """Ask the gate, and command the wheels."""
        was_moving = self.decision.allowed != REST
        decision = self._gate.decide(now, self.refused, driven=self.accepted)
        if self.accepted:
            allowed = decision.allowed
            self._outputs.append(Output(commands.base_control(*allowed), stop=was_moving and allowed == REST))
        return decision

    def safety_state(self, stamp: int, now: float) -> SafetyState:
        """The last decision, as it is published."""
        return self._gate.state(stamp, now)

    def reasons(self, now: float) -> Reasons:
        """What of the last decision is news when it changes."""
        return self._gate.reasons(now)

    # ---- what is asked for

    def requests(self) -> dict[str, Reply]:
        """What answers each request but stop."""
        return {
            "clear_safety": self._clear,
            "reset_odometry": self._reset,
            "led": self._peripherals.led,
            "sound": self._peripherals.sound,
            "digital_output": self._peripherals.digital_output,
            "gains": self._ask_gains,
            "version": lambda _: self._handshake.answer(),
        }

    def _clear(self, _: Answer) -> Answer:
        self._gate.clear()
        return done("cleared")

    def _reset(self, _: Answer) -> Answer:
        self._origin = self._origin.then(Pose2D(*self._odometry.pose))
        self._odometry.reset()
        return done("here is the origin")

    def _ask_gains(self, parameters: Answer) -> Answer | Future[Answer]:
        firmware = self._handshake.firmware
        if firmware and not has_gains(firmware):
            return failed(f"firmware {firmware} has no gains to report")
        return self._gains.request(parameters)

    def _send(self, data: bytes) -> None:
        if not self.accepted:
            raise PortLost("the base is not connected")
        self._outputs.append(Output(data))

    # ---- a packet

    def _packet(self, feedback: Feedback, stamp: int, now: float) -> Report | None:
        for skipped in feedback.skipped:
            self._warn("bad_sub_payload", str(skipped))
        if self._handshake.receive(feedback) and self._handshake.accepted:
            self._peripherals.resend()
        if feedback.gains:
            self._gains.receive(feedback.gains)
        core = feedback.core
        if core is None or not self._handshake.accepted or self._is_repeated(core):
            return None
        estimate = self._odometry.update(core, feedback.inertia, now)
        pose = self._origin.then(Pose2D(*estimate.pose))
        baseline = estimate.new_baseline or ""
        unmeasured = self._base_time_since(core) if baseline else 0.0
        motion = self._motion(feedback, core, begins=bool(baseline) or self._gate.catching_up)
        report = BaseReport(contacts(core), pose, motion, baseline, estimate.contradiction, unmeasured)
        self._gate.report(report, stamp, now)
        self.decide(now)
        return Report(feedback, core, estimate, stamp)

    def _is_repeated(self, core: Core) -> bool:
        """Whether the base's clock has not gone on: then nothing in the packet is new."""
        return self._read is not None and core.timestamp == self._read[0].timestamp

    def _base_time_since(self, core: Core) -> float:
        """How much time [s] of the base's clock, which counts 65 s, passed since the last packet; infinite at first."""
        return math.inf if self._read is None else ((core.timestamp - self._read[0].timestamp) & 0xFFFF) / 1000.0

    def _motion(self, feedback: Feedback, core: Core, begins: bool) -> Motion | None:
        """How far the base has gone since it began to report in time; None where it begins with this packet."""
        angle = feedback.inertia.angle if feedback.inertia else None
        if self._read is None or begins:
            self._read = (core, Motion(0.0, 0.0, 0.0, angle))
            return None
        before, (clock, left, right, gyro) = self._read
        clock += self._base_time_since(core)
        left += _ticks(before.left_encoder, core.left_encoder) * METRES_PER_TICK
        right += _ticks(before.right_encoder, core.right_encoder) * METRES_PER_TICK
        if gyro is None:
            gyro = angle
        elif angle is not None:
            gyro += math.remainder(angle - gyro, math.tau)
        self._read = (core, Motion(clock, left, right, gyro))
        return self._read[1]


def _ticks(before: int, after: int) -> int:
    return (after - before + 0x8000 & 0xFFFF) - 0x8000
