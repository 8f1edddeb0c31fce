"""The Kobuki's feedback, decoded: a payload is a sequence of sub-payloads `id | length | data`, little-endian.

A sub-payload that cannot be read costs nothing but itself: it is listed and skipped by the length it declares.
Source: Kobuki protocol.
"""

import math
from collections.abc import Callable, Iterator
from struct import Struct
from typing import Any, NamedTuple

from cliffscan.services.kobuki.protocol.sensors import (
    VOLTS_PER_COUNT,
    AngularRate,
    Bumper,
    Button,
    Charger,
    Cliff,
    CliffCounts,
    Core,
    DockIr,
    DockSignal,
    Gains,
    GainSet,
    GpInput,
    Gyro,
    Inertia,
    MotorCurrent,
    Overcurrent,
    Udid,
    WheelDrop,
)
from cliffscan.services.kobuki.protocol.versions import OLD_FIRMWARE_CODES, OLD_HARDWARE_CODES, UNREPORTED, Version

CENTIDEGREE = math.radians(0.01)
GYRO_DIGIT = math.radians(0.00875)  # [rad/s]

CORE = Struct("<H3B2H2b4B")
DOCK_IR = Struct("<3B")
INERTIA = Struct("<2h3x")
CLIFF = Struct("<3H")
CURRENT = Struct("<2B")
VERSION = Struct("<3Bx")
VERSION_CODE = Struct("<H")
GYRO_HEAD = Struct("<2B")
GYRO_SAMPLE = Struct("<3h")
GP_INPUT = Struct("<5H6x")
UDID = Struct("<3I")
GAINS = Struct("<B3I")

BYTES = range(256)
BUMPERS = tuple(map(Bumper, BYTES))  # looked up, for making one takes ten times as long
WHEEL_DROPS = tuple(map(WheelDrop, BYTES))
CLIFFS = tuple(map(Cliff, BYTES))
BUTTONS = tuple(map(Button, BYTES))
CHARGERS = tuple(map(Charger, BYTES))
OVERCURRENTS = tuple(map(Overcurrent, BYTES))
DOCK_SIGNALS = tuple(map(DockSignal, BYTES))

OLD_LENGTH = 54  # of firmware before 1.0.0, whose sub-payloads have ids at these places, but no lengths:
OLD_IDS = ((0, 1), (15, 3), (19, 4), (27, 5), (34, 6), (37, 16))


class PacketError(ValueError):
    """A sub-payload is malformed; the text says what was expected."""


class Skipped(NamedTuple):
    """A sub-payload that could not be read, and why."""

    id: int
    why: str

    def __str__(self) -> str:
        return f"sub-payload {self.id}: {self.why}"


class Feedback(NamedTuple):
    """What one payload holds; a field is None where it holds no such sub-payload, and the last counts of several.

    Only a payload with a core is fresh news of the base: an empty one is a good frame, too.
    """

    core: Core | None = None
    dock_ir: DockIr | None = None
    inertia: Inertia | None = None
    cliff: CliffCounts | None = None
    current: MotorCurrent | None = None
    hardware: Version | None = None
    firmware: Version | None = None  # UNREPORTED for the packets of firmware before 1.0.0, which hold nothing else
    gyro: Gyro | None = None
    gp_input: GpInput | None = None
    udid: Udid | None = None
    gains: Gains | None = None
    skipped: tuple[Skipped, ...] = ()


def decode(payload: bytes) -> Feedback:
    """All sub-payloads of `payload`; whatever it is, nothing is raised."""
    if _is_old(payload):
        return Feedback(firmware=UNREPORTED)
    found: dict[str, Any] = {}
    skipped = []
    for ident, data, whole in _sub_payloads(payload):
        try:
            name, read = _reader(ident, whole)
            found[name] = read(data)
        except PacketError as error:
            skipped.append(Skipped(ident, str(error)))
    return Feedback(**found, skipped=tuple(skipped))


def _is_old(payload: bytes) -> bool:
    return len(payload) == OLD_LENGTH and all(payload[place] == ident for place, ident in OLD_IDS)


def _sub_payloads(payload: bytes) -> Iterator[tuple[int, bytes, bool]]:
    """Id and data of each, and whether all of it is there: the last may run past the end, or lack its length."""
    start, size = 0, len(payload)
    while start < size:
        end = start + 2 + payload[start + 1] if start + 1 < size else size + 1
        yield payload[start], payload[start + 2 : end], end <= size
        start = end


def _reader(ident: int, whole: bool) -> tuple[str, Callable[[bytes], Any]]:
    """The field of Feedback that a sub-payload fills, and what reads it."""
    if not whole:
        raise PacketError("runs past the end of its packet")
    if ident not in READERS:
        raise PacketError("unknown id")
    return READERS[ident]


def _unpack(layout: Struct, data: bytes) -> tuple[int, ...]:
    if len(data) != layout.size:
        raise PacketError(f"{len(data)} bytes, expected {layout.size}")
    return layout.unpack(data)


def _core(data: bytes) -> Core:
    stamp, bumper, drop, cliff, left, right, left_pwm, right_pwm, buttons, charger, battery, over = _unpack(CORE, data)
    return Core(
        stamp,
        BUMPERS[bumper],
        WHEEL_DROPS[drop],
        CLIFFS[cliff],
        left,
        right,
        left_pwm,
        right_pwm,
        BUTTONS[buttons],
        CHARGERS[charger],
        battery / 10,
        OVERCURRENTS[over],
    )


def _dock_ir(data: bytes) -> DockIr:
    return DockIr(*(DOCK_SIGNALS[signals] for signals in _unpack(DOCK_IR, data)))


def _inertia(data: bytes) -> Inertia:
    angle, rate = _unpack(INERTIA, data)
    return Inertia(angle * CENTIDEGREE, rate * CENTIDEGREE)


def _cliff(data: bytes) -> CliffCounts:
    return CliffCounts(*_unpack(CLIFF, data))


def _current(data: bytes) -> MotorCurrent:
    left, right = _unpack(CURRENT, data)
    return MotorCurrent(left / 100, right / 100)


def _version(data: bytes, old_codes: dict[int, Version]) -> Version:
    if len(data) != VERSION_CODE.size:
        patch, minor, major = _unpack(VERSION, data)
        return Version(major, minor, patch)
    (code,) = VERSION_CODE.unpack(data)
    if code not in old_codes:
        raise PacketError(f"version code {code}, expected one of {', '.join(map(str, sorted(old_codes)))}")
    return old_codes[code]


def _gyro(data: bytes) -> Gyro:
    """The samples, turned from the sensor's axes to the robot's."""
    frame_id, count = _unpack(GYRO_HEAD, data[: GYRO_HEAD.size])
    words = data[GYRO_HEAD.size :]
    if len(words) != 2 * count or count % 3:
        raise PacketError(f"{len(words)} bytes of samples, expected 3 numbers of 2 bytes each, {count} in all")
    samples = [
        AngularRate(-y * GYRO_DIGIT, x * GYRO_DIGIT, z * GYRO_DIGIT) for x, y, z in GYRO_SAMPLE.iter_unpack(words)
    ]
    return Gyro(frame_id, tuple(samples))


def _gp_input(data: bytes) -> GpInput:
    digital, a, b, c, d = _unpack(GP_INPUT, data)
    volts = (a * VOLTS_PER_COUNT, b * VOLTS_PER_COUNT, c * VOLTS_PER_COUNT, d * VOLTS_PER_COUNT)
    return GpInput((bool(digital & 1), bool(digital & 2), bool(digital & 4), bool(digital & 8)), volts)


def _udid(data: bytes) -> Udid:
    return Udid(*_unpack(UDID, data))


def _gains(data: bytes) -> Gains:
    kind, p, i, d = _unpack(GAINS, data)
    if kind not in tuple(GainSet):
        raise PacketError(f"gains of type {kind}, expected 0 (factory) or 1 (user)")
    return Gains(GainSet(kind), p / 1000, i / 1000, d / 1000)


READERS: dict[int, tuple[str, Callable[[bytes], Any]]] = {
    1: ("core", _core),
    3: ("dock_ir", _dock_ir),
    4: ("inertia", _inertia),
    5: ("cliff", _cliff),
    6: ("current", _current),
    10: ("hardware", lambda data: _version(data, OLD_HARDWARE_CODES)),
    11: ("firmware", lambda data: _version(data, OLD_FIRMWARE_CODES)),
    13: ("gyro", _gyro),
    16: ("gp_input", _gp_input),
    19: ("udid", _udid),
    21: ("gains", _gains),
}
