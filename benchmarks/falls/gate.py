"""The driver's side of a base, as services/kobuki/bridge.py has it, in a time that is given."""

from __future__ import annotations

from common.messages import LaserScan
from services.kobuki import commands
from services.kobuki.config import KobukiConfig
from services.kobuki.frames import FrameParser
from services.kobuki.ground import Pose
from services.kobuki.handshake import Handshake
from services.kobuki.history import PoseHistory
from services.kobuki.odometry import Odometry
from services.kobuki.packets import Feedback, decode
from services.kobuki.safety import REST, Decision, Safety, Scan, Twist
from services.kobuki.sensors import Core

SECOND = 1_000_000_000  # [ns]


class Gate:
    """Hears a base's bytes, commands and scans, and says the bytes that go down to the base. Times are in [s]."""

    def __init__(self, config: KobukiConfig | None = None) -> None:
        start = Pose(0.0, 0.0, 0.0)
        self.decision = Decision("no_base", REST, REST)
        self.core: Core | None = None
        self._safety = Safety(config or KobukiConfig(), start)
        self._parser, self._handshake = FrameParser(), Handshake()
        self._odometry, self._history = Odometry(), PoseHistory()

    def hear(self, data: bytes, now: float) -> bytes:
        """Take in what the base said; the answer to it."""
        return b"".join(self._packet(decode(payload), now) for payload in self._parser.feed(data))

    def command(self, asked: Twist, now: float) -> bytes:
        """Somebody wants the robot to move; what the wheels get to hear of it."""
        self._safety.command(asked, now)
        return self._decide(now)

    def see(self, scan: LaserScan, now: float) -> None:
        """A scan came, that was taken at its stamp."""
        pose = self._history.at(scan.stamp)
        if pose is not None:
            self._safety.see(Scan.of(scan), pose, scan.stamp / SECOND, now)

    def _packet(self, feedback: Feedback, now: float) -> bytes:
        self._handshake.hear(feedback)
        if feedback.core is None or not self._handshake.accepted:
            return self._handshake.request(now)
        self.core = feedback.core
        estimate = self._odometry.update(feedback.core, feedback.inertia, now)
        pose = Pose(*estimate.pose)
        if estimate.new_baseline:
            self._safety.restart(pose)
        self._history.add(round(now * SECOND), pose)
        self._safety.sense(feedback.core, pose)
        return self._decide(now)

    def _decide(self, now: float) -> bytes:
        self.decision = self._safety.decide(now)
        if not self._handshake.accepted:
            return b""
        return commands.base_control(*self.decision.allowed)
