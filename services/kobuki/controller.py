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
from cliffscan.safety.inputs import REST
from cliffscan.safety.message_gate import MessageGate, Warn
from cliffscan.safety.odometry_monitor import OdometryMonitor
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.rules import Decision
from cliffscan.services.kobuki.command_handlers import Answer, GainsHandler, Reply, done, failed
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.contacts import contacts
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

TICK = 0.03  # [s] between decisions when the base is silent; it is not while it sends its packet every 0.02 s
SILENT = 0.2  # [s] in which the base's clock stood still
BOTH_SIMULATED = "the camera is simulated and the base is real: set capture.source to the camera on the robot"


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
        self._gate = MessageGate(config.limits(), warn)
        self._monitor = OdometryMonitor(WHEEL_SEPARATION)
        self._outputs: list[Output] = []
        self._peripherals, self._gains = Peripherals(self._send), GainsHandler(self._send)
        self._camera: CameraDescription | None = None
        self._decided_at = -math.inf
        self.connected = self.simulated = False
        self._begin(-math.inf)

    def _begin(self, now: float) -> None:
        """Know nothing of the base."""
        self._parser, self._handshake = FrameParser(), Handshake()
        self._monitor.begin()
        self.catching_up = False  # with what the base sent while nobody read it
        self._read: tuple[Core, float, float, float, float] | None = None  # core, clock, left, right, gyro unwrapped
        self.alive_at = now  # [s] when the base's clock last went on

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
        self.catching_up = False

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
        self._camera = camera
        self._gate.describe(camera)

    def stop(self, now: float) -> None:
        """The emergency stop."""
        self._gate.stop("asked to")
        self.decide(now)

    def tick(self, now: float) -> None:
        """Time passes: notice a silent base, ask what it has not answered, decide where no packet asks for it."""
        if now - self.alive_at > SILENT:
            self._gate.lose_base("the base's clock stands still" if self.connected and self._read else "")
        if self._parser.counts.good and (request := self._handshake.request(now)):
            self._outputs.append(Output(request))
        if now - self._decided_at >= TICK:
            self.decide(now)

    # ---- what is decided

    def decide(self, now: float) -> Decision:
        """Ask the gate, and command the wheels."""
        self._decided_at = now
        was_moving = self.decision.allowed != REST
        decision = self._gate.decide(now, self.refused)
        if self.accepted:
            allowed = decision.allowed
            self._outputs.append(Output(commands.base_control(*allowed), stop=was_moving and allowed == REST))
            self._monitor.send(*allowed, now)
        return decision

    def safety_state(self, stamp: int, now: float) -> SafetyState:
        """The last decision, as it is published."""
        return self._gate.state(stamp, now)

    def reasons(self, now: float) -> tuple[str, bool, str]:
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
        self._monitor.begin()
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
        self.alive_at = now
        estimate = self._odometry.update(core, feedback.inertia, now)
        pose = self._origin.then(Pose2D(*estimate.pose))
        if estimate.new_baseline:
            self._warn("baseline", estimate.new_baseline)
            self.catching_up = True
        if self.catching_up:  # what is read late is of where the robot was; it begins anew where it is
            self._gate.restart(pose)
            self._monitor.begin()
        if estimate.contradiction:
            self._gate.doubt(f"the odometry contradicts itself: {estimate.new_baseline}", now)
        self._gate.sense(contacts(core), pose, stamp)
        self._watch_wheels(feedback, core, now)
        self.decide(now)
        return Report(feedback, core, estimate, stamp)

    def _is_repeated(self, core: Core) -> bool:
        """Whether the base's clock has not gone on: then nothing in the packet is new."""
        return self._read is not None and core.timestamp == self._read[0].timestamp

    def _watch_wheels(self, feedback: Feedback, core: Core, now: float) -> None:
        angle = feedback.inertia.angle if feedback.inertia else math.nan
        if self._read is None or self.catching_up:
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
            self._gate.distrust(stuck)
        if wrong := self._monitor.contradicted() or self._monitor.runaway(now):
            self._gate.doubt(wrong, now)


def _ticks(before: int, after: int) -> int:
    return (after - before + 0x8000 & 0xFFFF) - 0x8000
