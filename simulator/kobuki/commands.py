"""What a driver can tell the base: the sub-payloads of a command frame."""

import struct
from dataclasses import dataclass
from typing import ClassVar

SOUND_TICK = 2.75e-6  # [s] unit of a note's period


class Command:
    """Something a driver told the base."""

    name: ClassVar[str]


@dataclass(frozen=True)
class BaseControl(Command):
    """Speed of the outer wheel [mm/s], radius of the robot's arc [mm]; radius 0: straight on, 1: on the spot."""

    name = "base_control"
    speed: int
    radius: int


@dataclass(frozen=True)
class Sound(Command):
    """A tone: its period in units of 2.75 µs, its duration [ms]."""

    name = "sound"
    note: int
    duration: int

    @property
    def frequency(self) -> float:
        """Frequency [Hz]; 0 for a note of no period."""
        return 1.0 / (self.note * SOUND_TICK) if self.note else 0.0


@dataclass(frozen=True)
class SoundSequence(Command):
    """A melody: 0 on, 1 off, 2 recharge, 3 button, 4 error, 5 cleaning start, 6 cleaning end."""

    name = "sound_sequence"
    number: int


@dataclass(frozen=True)
class Request(Command):
    """What to tell about itself: 1 hardware, 2 firmware, 8 unique identifier."""

    name = "request"
    flags: int


@dataclass(frozen=True)
class Output(Command):
    """The one word of all outputs: 0x000F digital, 0x00F0 supplies, 0x0F00 LEDs."""

    name = "output"
    word: int


@dataclass(frozen=True)
class SetGains(Command):
    """The wheel controller's gains times 1000; kind 0: the factory's, 1: these."""

    name = "set_gains"
    kind: int
    p: int
    i: int
    d: int


@dataclass(frozen=True)
class GetGains(Command):
    """Tell the wheel controller's gains; its one byte means nothing."""

    name = "get_gains"
    unused: int


@dataclass(frozen=True)
class Unknown(Command):
    """A sub-payload that is none of the above, or not of the length it should be."""

    name = "unknown"
    identifier: int
    data: bytes


KINDS: dict[int, tuple[str, type[Command]]] = {  # identifier: layout of the data, command
    1: ("<hh", BaseControl),
    3: ("<HB", Sound),
    4: ("<B", SoundSequence),
    9: ("<H", Request),
    12: ("<H", Output),
    13: ("<BIII", SetGains),
    14: ("<B", GetGains),
}


def decode(payload: bytes) -> list[Command]:
    """The commands of a payload, in order; every sub-payload is left behind by the length it declares."""
    commands = []
    while payload:
        size = 2 + payload[1] if len(payload) > 1 else 1
        commands.append(_command(payload[0], payload[2:size], complete=1 < size <= len(payload)))
        payload = payload[size:]
    return commands


def _command(identifier: int, data: bytes, complete: bool) -> Command:
    layout, kind = KINDS.get(identifier, ("", Unknown))
    if kind is Unknown or not complete or len(data) != struct.calcsize(layout):
        return Unknown(identifier, data)
    return kind(*struct.unpack(layout, data))
