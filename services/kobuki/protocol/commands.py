"""Commands to the Kobuki as the bytes that go down the wire. Source: Kobuki protocol.

Something impossible raises a ValueError, whose text has what was expected.
"""

from __future__ import annotations

from enum import IntEnum
from struct import Struct
from typing import NamedTuple

from cliffscan.services.kobuki.kinematics import speed_and_radius
from cliffscan.services.kobuki.protocol.frames import frame
from cliffscan.services.kobuki.protocol.sensors import Gains, GainSet

BASE_CONTROL, SOUND, SOUND_SEQUENCE, REQUEST, GP_OUTPUT, SET_GAINS, GET_GAINS = 1, 3, 4, 9, 12, 13, 14

SPEED_AND_RADIUS = Struct("<2h")  # made once: it is packed at every decision
HARDWARE, FIRMWARE, UDID = 1, 2, 8  # what can be requested
NOTE_PERIOD = 0.00000275  # [s], of which a note's period is a multiple
LONGEST_NOTE = 0.255  # [s]
LARGEST_GAIN = 0xFFFFFFFF / 1000
DIGITAL_OUTPUTS = 4
LED_BITS = {1: 8, 2: 10}  # where an LED's colour begins


class SoundSequence(IntEnum):
    """The melodies that the base knows."""

    ON = 0
    OFF = 1
    RECHARGE = 2
    BUTTON = 3
    ERROR = 4
    CLEANING_START = 5
    CLEANING_END = 6


class LedColour(IntEnum):
    """Colours of the two LEDs."""

    OFF = 0
    RED = 1
    GREEN = 2
    ORANGE = 3


class Supply(IntEnum):
    """External power supplies, as their bits of the output word."""

    V3_3 = 0x10
    V5 = 0x20
    V12_5A = 0x40
    V12_1A5 = 0x80


class Outputs(NamedTuple):
    """Digital outputs, external supplies and LEDs: one shared word, which every command sends whole.

    It starts with every supply on, for a computer or a camera on the base lives on one of them.
    """

    word: int = Supply.V3_3 | Supply.V5 | Supply.V12_5A | Supply.V12_1A5

    def with_led(self, led: int, colour: LedColour) -> Outputs:
        """The same with LED 1 or 2 in another colour."""
        if led not in LED_BITS:
            raise ValueError(f"LED {led}, expected 1 or 2")
        both = LedColour.ORANGE << LED_BITS[led]
        return Outputs(self.word & ~both | _one_of(LedColour, colour) << LED_BITS[led])

    def with_digital_output(self, output: int, on: bool) -> Outputs:
        """The same with a digital output, 0 to 3, switched."""
        if output not in range(DIGITAL_OUTPUTS):
            raise ValueError(f"digital output {output}, expected 0 to {DIGITAL_OUTPUTS - 1}")
        return self._switched(1 << output, on)

    def with_supply(self, supply: Supply, on: bool) -> Outputs:
        """The same with an external supply switched."""
        return self._switched(_one_of(Supply, supply), on)

    def encode(self) -> bytes:
        """The command that sets all of it."""
        return _command(GP_OUTPUT, Struct("<H"), self.word)

    def _switched(self, bit: int, on: bool) -> Outputs:
        return Outputs(self.word | bit if on else self.word & ~bit)


def base_control(linear: float, angular: float) -> bytes:
    """Drive at `linear` [m/s] and `angular` [rad/s]. Raises ValueError where one is no number."""
    return _command(BASE_CONTROL, SPEED_AND_RADIUS, *speed_and_radius(linear, angular))


def sound(frequency: float, duration: float) -> bytes:
    """A note of `frequency` [Hz] for `duration` [s]. Raises ValueError where the base cannot play it."""
    lowest, highest = 1 / (0xFFFF * NOTE_PERIOD), 1 / NOTE_PERIOD
    if not lowest <= frequency <= highest:
        raise ValueError(f"frequency of {frequency} Hz, expected {lowest:.2f} to {highest:.0f} Hz")
    if not 0.001 <= duration <= LONGEST_NOTE:
        raise ValueError(f"duration of {duration} s, expected 0.001 to {LONGEST_NOTE} s")
    return _command(SOUND, Struct("<HB"), round(1 / (frequency * NOTE_PERIOD)), round(1000 * duration))


def sound_sequence(sequence: SoundSequence) -> bytes:
    """One of the base's own melodies."""
    return _command(SOUND_SEQUENCE, Struct("<B"), _one_of(SoundSequence, sequence))


def request_versions() -> bytes:
    """Ask for the versions of hardware and firmware and for the unique number."""
    return _command(REQUEST, Struct("<H"), HARDWARE | FIRMWARE | UDID)


def set_gains(gains: Gains) -> bytes:
    """Set the wheel controller's gains. Raises ValueError where one does not fit."""
    kind, *values = gains
    for name, gain in zip("pid", values, strict=True):
        if not 0.0 <= gain <= LARGEST_GAIN:
            raise ValueError(f"gain {name} of {gain}, expected 0 to {LARGEST_GAIN}")
    return _command(SET_GAINS, Struct("<B3I"), _one_of(GainSet, kind), *(round(1000 * gain) for gain in values))


def get_gains() -> bytes:
    """Ask for the wheel controller's gains."""
    return _command(GET_GAINS, Struct("<x"))


def _one_of(kind: type[IntEnum], value: int) -> int:
    if value not in tuple(kind):
        expected = ", ".join(f"{member.value} ({member.name.lower()})" for member in kind)
        raise ValueError(f"{kind.__name__} {value}, expected one of {expected}")
    return value


def _command(ident: int, layout: Struct, *values: int) -> bytes:
    return frame(bytes([ident, layout.size]) + layout.pack(*values))
