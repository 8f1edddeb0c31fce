"""What the base tells: the sub-payloads of a feedback frame, and the payload they make."""

import struct
from collections.abc import Sequence
from typing import NamedTuple

from cliffscan.simulator.kobuki.sensors import SIDES, Sensors
from cliffscan.simulator.kobuki.versions import Identity, firmware_bytes, version_bytes

Triple = tuple[int, int, int]

ADC_MAX = 0x0FFF
OLD_CORE = 14  # [bytes] before 1.0.0, when there was no overcurrent flag


class SubPayload(NamedTuple):
    """One part of a payload: what it is, and its data."""

    identifier: int
    data: bytes


class Gains(NamedTuple):
    """The wheel controller's gains times 1000; kind 0: the factory's, 1: the user's."""

    kind: int
    p: int
    i: int
    d: int


FACTORY_GAINS = Gains(0, 100_000, 100, 2_000)


def payload(parts: Sequence[SubPayload]) -> bytes:
    """A payload of these parts, each told with its length."""
    return b"".join(bytes([part.identifier, len(part.data)]) + part.data for part in parts)


def old_payload(parts: Sequence[SubPayload]) -> bytes:
    """A payload as firmware before 1.0.0 made them: without the lengths."""
    return b"".join(bytes([part.identifier]) + part.data for part in parts)


def core(stamp: int, sensors: Sensors, encoders: tuple[int, int], pwm: tuple[int, int]) -> SubPayload:
    """The base's time [ms, 16 bits], its flags, encoders (16 bits), motor power (-128 to 127), and battery."""
    flags = (sensors.bumper, sensors.wheel_drop, sensors.cliff)
    ends = (sensors.button, sensors.charger, saturated(10 * sensors.battery, 255), sensors.overcurrent)
    return SubPayload(1, struct.pack("<HBBBHHbbBBBB", stamp, *flags, *encoders, *pwm, *ends))


def old_core(part: SubPayload) -> SubPayload:
    """The core as firmware before 1.0.0 told it."""
    return SubPayload(part.identifier, part.data[:OLD_CORE])


def dock_ir(sensors: Sensors) -> SubPayload:
    """Which of the docking station's beams each receiver sees."""
    return SubPayload(3, bytes(saturated(sensors.dock_ir[side], 63) for side in SIDES))


def inertia(angle: int, rate: int) -> SubPayload:
    """Heading since power-on [0.01°, -18000 to 18000] and its rate [0.01°/s, 16 bits]."""
    return SubPayload(4, struct.pack("<hh3x", angle, rate))


def cliff(sensors: Sensors) -> SubPayload:
    """The cliff sensors' raw readings."""
    return SubPayload(5, struct.pack("<3H", *(saturated(sensors.cliff_adc[side], ADC_MAX) for side in SIDES)))


def current(sensors: Sensors) -> SubPayload:
    """The motors' currents."""
    return SubPayload(6, bytes(saturated(100 * sensors.current[side], 255) for side in ("left", "right")))


def raw_gyro(first: int, samples: Sequence[Triple]) -> SubPayload:
    """Samples of the gyro [0.00875 °/s] about its own x, y and z; first: the number of the first one, 0 to 255."""
    values = [value for sample in samples for value in sample]
    return SubPayload(13, struct.pack(f"<BB{len(values)}h", first, len(values), *values))


def inputs(sensors: Sensors) -> SubPayload:
    """The expansion port's inputs."""
    analog = (saturated(value, ADC_MAX) for value in sensors.analog_input)
    return SubPayload(16, struct.pack("<5H6x", sensors.digital_input, *analog))


def hardware(identity: Identity) -> SubPayload:
    """The hardware's version."""
    return SubPayload(10, version_bytes(identity.hardware, identity.firmware))


def firmware(identity: Identity) -> SubPayload:
    """The firmware's version."""
    return SubPayload(11, firmware_bytes(identity.firmware))


def udid(identity: Identity) -> SubPayload:
    """The identifier that no other base has."""
    return SubPayload(19, struct.pack("<3I", *identity.udid))


def controller(gains: Gains) -> SubPayload:
    """The wheel controller's gains."""
    return SubPayload(21, struct.pack("<B3I", *gains))


def saturated(value: float, limit: int) -> int:
    """The nearest number from 0 to the limit."""
    return max(0, min(limit, round(value)))
