"""The base's firmware as a function of bytes and time: no clock, no port."""

import math
from collections import Counter
from dataclasses import dataclass, field, replace

from cliffscan.simulator.kobuki import feedback
from cliffscan.simulator.kobuki.commands import BaseControl, Command, GetGains, Output, Request, SetGains, decode
from cliffscan.simulator.kobuki.drive import Drive, RampedWheels
from cliffscan.simulator.kobuki.feedback import FACTORY_GAINS, Gains, SubPayload
from cliffscan.simulator.kobuki.frames import FrameFinder, frame
from cliffscan.simulator.kobuki.gyro import Gyro
from cliffscan.simulator.kobuki.kinematics import REST, Wheels, clamp, ticks, wheel_speeds
from cliffscan.simulator.kobuki.motors import Motors
from cliffscan.simulator.kobuki.sensors import Sensors
from cliffscan.simulator.kobuki.ticker import SECOND, Ticker, nanoseconds
from cliffscan.simulator.kobuki.versions import FIRST_WITH_GAINS, FIRST_WITH_LENGTHS, Identity, Version

PACKET_PERIOD = 20_000_000  # [ns]
SUPPLIES_ON = 0x00F0  # the outputs at power-on
DEAD_TIME = 0.2  # [s] from a command to the wheels' first answer, measured on 1.2.0: github yujinrobot/kobuki issue 389
HARDWARE, FIRMWARE, UDID = 1, 2, 8  # what a request may ask for
PWM_PER_SPEED = 180.0  # [s/m] real bases show about 13 at 0.03 m/s and 30 at 0.12 m/s


@dataclass
class Received:
    """The last command of each kind, when it came [s], and how many did."""

    last: dict[str, Command] = field(default_factory=dict)
    time: dict[str, float] = field(default_factory=dict)
    count: Counter[str] = field(default_factory=Counter)


class EncoderFault:
    """What is wrong with the encoders: they count a share of the way only, 0 for nothing, 1 for all of it."""

    def __init__(self) -> None:
        self._shares = Wheels(1.0, 1.0)
        self._turned = self._told = REST  # [m] when the shares were set

    def count(self, shares: Wheels, turned: Wheels) -> None:
        """Count these shares of the way from now on, when the wheels have turned so far [m]. Raises ValueError."""
        if not all(math.isfinite(share) for share in shares):
            raise ValueError(f"shares of {shares.left}, {shares.right}, expected numbers")
        self._turned, self._told = turned, self.read(turned)
        self._shares = shares

    def read(self, turned: Wheels) -> Wheels:
        """What the encoders tell [m] of how far the wheels have turned [m]."""
        left, right = (
            told + share * (now - then)
            for told, share, now, then in zip(self._told, self._shares, turned, self._turned, strict=True)
        )
        return Wheels(left, right)


class Firmware:
    """A base: hears commands, drives its wheels, and tells what it senses every 20 ms.

    What is not published about the real firmware is assumed as the driver's worst case: no timeout of its own (the last
    command holds for ever), no reflex to bumpers, cliffs and wheel drops (true from 1.1.2 on), motors that run
    again as soon as an overcurrent is over, and settings that do not outlast the power.

    drive: the wheels; dead_time: [s]. Raises ValueError for a dead time that is negative or not finite.
    """

    def __init__(
        self, drive: Drive | None = None, identity: Identity | None = None, dead_time: float = DEAD_TIME
    ) -> None:
        self.drive = drive if drive is not None else RampedWheels()
        self.identity = identity or Identity()
        self.sensors = Sensors()
        self.received = Received()
        self.packets = 0  # sent in all
        self.discarded = 0  # [bytes] heard that belonged to no command
        self.encoders = EncoderFault()
        self.clock_stands = False  # a fault: the base's own time does not go on
        self._dead_time = nanoseconds(dead_time)
        self._clock = 0  # [ns] since the base was made
        self._boot()

    def _boot(self) -> None:
        self.output = SUPPLIES_ON
        self.gains = FACTORY_GAINS
        self.motors = Motors(self.drive, self._dead_time)
        self._off = 0  # [ns] until the power comes back
        self._stamp = 0  # [ns] of the base's own time
        self._origin = self.drive.travelled
        self._gyro = Gyro(self.drive)
        self._packet_due = Ticker(PACKET_PERIOD)
        self._finder = FrameFinder()
        self._answers: dict[int, SubPayload] = {}

    @property
    def time(self) -> float:
        """Time [s] since the base was made."""
        return self._clock / SECOND

    @property
    def uptime(self) -> float:
        """The base's own time [s], from which its 16-bit stamps come."""
        return self._stamp / SECOND

    @property
    def powered(self) -> bool:
        """False while the base is switched off."""
        return self._off == 0

    def until_packet(self) -> float:
        """Time [s] to the next packet, or to the power's return."""
        return (self._packet_due.left if self.powered else self._off) / SECOND

    def power_cycle(self, seconds: float = 1.0) -> None:
        """Switch the base off, and on again later. It forgets all but its version; encoders, heading and time restart.

        Raises ValueError for a span that is negative or not finite.
        """
        off = nanoseconds(seconds)
        self._boot()
        self._off = off

    def flash(self, version: Version) -> None:
        """Put another version of the firmware on the base, which restarts with it."""
        self.identity = replace(self.identity, firmware=version)
        self._boot()

    def skip(self, seconds: float) -> None:
        """Have the base's own time jump ahead [s]. Raises ValueError for a span that is negative or not finite."""
        self._stamp += nanoseconds(seconds)

    def receive(self, data: bytes) -> list[Command]:
        """Hear bytes from the driver, cut anywhere. The commands that are complete with them, already obeyed."""
        if not self.powered:
            return []
        before = self._finder.discarded
        commands = [command for payload in self._finder.feed(data) for command in decode(payload)]
        self.discarded += self._finder.discarded - before
        for command in commands:
            self._obey(command)
        return commands

    def step(self, dt: float) -> bytes:
        """Let time pass [s]; what the base says in it. Raises ValueError for a span that is negative or not finite."""
        said = bytearray()
        left = nanoseconds(dt)
        while left > 0:
            part = min(left, self._until())
            said += self._pass(part)
            left -= part
        return bytes(said)

    def _until(self) -> int:
        """Time [ns] in which nothing happens but wheels turning."""
        if not self.powered:
            return min(self._off, PACKET_PERIOD)
        return min(self._packet_due.left, self._gyro.until(), self.motors.until())

    def _pass(self, ns: int) -> bytes:
        self._clock += ns
        self.motors.advance(ns, cut=not self.powered or self.sensors.overcurrent != 0)
        if not self.powered:
            self._off -= ns
            if self.powered:
                self._boot()
            return b""
        self._stamp += 0 if self.clock_stands else ns
        self._gyro.advance(ns)
        return self._packet() if self._packet_due.advance(ns) else b""

    def _packet(self) -> bytes:
        self.packets += 1
        parts = self._streamed()
        if self.identity.firmware < FIRST_WITH_LENGTHS:
            return frame(feedback.old_payload([feedback.old_core(parts[0]), *parts[1:]]))
        gyro, inputs = feedback.raw_gyro(*self._gyro.take()), parts.pop()
        answers, self._answers = self._answers, {}
        return frame(feedback.payload([*parts, gyro, inputs, *(answers[identifier] for identifier in sorted(answers))]))

    def _streamed(self) -> list[SubPayload]:
        """What every firmware sends in every packet, in its order."""
        turned = self.encoders.read(self.drive.travelled)
        encoders = ticks(turned.left - self._origin.left), ticks(turned.right - self._origin.right)
        power = 0.0 if self.motors.cut else PWM_PER_SPEED
        left, right = (round(clamp(power * speed, 127.0)) for speed in self.drive.speeds)
        stamp = self._stamp // 1_000_000 & 0xFFFF
        return [
            feedback.core(stamp, self.sensors, encoders, (left, right)),
            feedback.dock_ir(self.sensors),
            feedback.inertia(self._gyro.angle(), self._gyro.rate()),
            feedback.cliff(self.sensors),
            feedback.current(self.sensors),
            feedback.inputs(self.sensors),
        ]

    def _obey(self, command: Command) -> None:
        self.received.last[command.name] = command
        self.received.time[command.name] = self.time
        self.received.count[command.name] += 1
        match command:
            case BaseControl(speed, radius):
                self.motors.command(wheel_speeds(speed, radius))
            case Output(word):
                self.output = word
            case Request(flags):
                self._tell_identity(flags)
            case SetGains(kind, p, i, d) if self.identity.firmware >= FIRST_WITH_GAINS:
                self.gains = Gains(kind, p, i, d) if kind else FACTORY_GAINS
            case GetGains() if self.identity.firmware >= FIRST_WITH_GAINS:
                self._answer(feedback.controller(self.gains))

    def _tell_identity(self, flags: int) -> None:
        for flag, tell in ((HARDWARE, feedback.hardware), (FIRMWARE, feedback.firmware), (UDID, feedback.udid)):
            if flags & flag:
                self._answer(tell(self.identity))

    def _answer(self, part: SubPayload) -> None:
        """Have the next packet tell this as well, once, however often it was asked for."""
        self._answers[part.identifier] = part
