"""All that reads messages, in one process: what it does with one is harmless, or it is refused."""

import math

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.safety.gate import SafetyGate
from cliffscan.safety.inputs import Command, Contacts, Twist
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.scan_claims import Scan
from cliffscan.services.fuse.config import ExtraInput
from cliffscan.services.fuse.fusion import GridMismatch, fuse
from cliffscan.services.fuse.pairing import Pair
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.protocol import commands
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.perception.perceive import Settings, perceive
from tests import build
from tests.hostile import Case

SETTINGS = Settings(methods=tuple(METHODS))
HERE = Pose2D(0.0, 0.0, 0.0)
TICK = 0.02  # [s]
HONEST = build.scan([2.0] * 100)
LONGEST_REFUSAL = 1500  # characters


class Readers:
    """Takes messages one after another; what was wrong with one must not change what becomes of the next."""

    def __init__(self) -> None:
        self._gate, self._now = SafetyGate(KobukiConfig().limits(), HERE), 100.0

    def take(self, case: Case) -> bool:
        """Whether it was taken. Raises whatever goes wrong, but for a message that was refused."""
        try:
            message = case.kind.decode(case.payload)
        except MessageError as error:
            _check_refusal(str(error))
            return False
        assert case.kind.decode(message.encode()).encode() == message.encode()
        self._work_on(message)
        return True

    def _work_on(self, message: Message) -> None:
        if isinstance(message, DepthImage):
            _look_at(message)
        elif isinstance(message, LaserScan):
            _fuse(message)
            self._gate.see(Scan.of(message, self._gate.view), HERE, self._now, self._now)
            self._drive(Twist(0.3, 0.1))
        elif isinstance(message, Velocity):
            self._drive(Twist(message.linear, message.angular))

    def _drive(self, asked: Twist) -> None:
        """What the gate lets through is something that a base may be told."""
        self._now += TICK
        self._gate.sense(Contacts(), HERE)
        allowed = self._gate.decide(Command(asked, self._now), self._now).allowed
        assert all(map(math.isfinite, allowed))
        assert abs(allowed.linear) <= 0.7001
        commands.base_control(*allowed)


def _check_refusal(why: str) -> None:
    """It is one short line."""
    assert 0 < len(why) < LONGEST_REFUSAL
    assert len(why.splitlines()) == 1


def _look_at(image: DepthImage) -> None:
    """The scans that are made of an image are scans that anybody takes."""
    positive, by_method, negative, fused = perceive(image, SETTINGS)
    for scan in (positive, *by_method.values(), negative, fused):
        LaserScan.decode(scan.encode())


def _fuse(scan: LaserScan) -> None:
    """On either side, and as an extra input."""
    extra = {"lidar": (ExtraInput(key="scan/lidar", x=0.1, yaw=10.0), scan)}
    for pair, extras in ((Pair(scan, scan), {}), (Pair(scan, HONEST), {}), (Pair(HONEST, HONEST), extra)):
        try:
            LaserScan.decode(fuse(pair, extras).encode())
        except GridMismatch:
            assert scan is not HONEST
