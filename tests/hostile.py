"""Messages as nobody should send them: good ones of every kind with wrong values, torn, or full of air.

Whatever comes of them must be refused with one line, or be harmless. A seed always gives the same messages.
"""

import math
import random
import struct
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import msgpack
import numpy as np
import zstandard

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry, SafetyState, Velocity
from cliffscan.common.contract.depth_codec import ENCODINGS, LEVELS, encode
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.message import Message
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus

Fields = dict[str, Any]

INTEGERS = [0, -1, 1, 2, 255, 2**16, 2**21, 2**22, 2**31, 2**32 - 1, 2**53, 2**63 - 1, 2**63, 2**64 - 1, -(2**63)]
FLOATS = [0.0, -0.0, 5e-324, 1e-300, 1e-40, 1e-9, 0.1, 0.5, 1.0, -1.0, 1e3, 1e5, 1e9, 3.5e38, 1e300, 1.7e308]
NO_NUMBERS = [math.inf, -math.inf, math.nan]
WORDS = ["", "x", "\u202e\U0001f600", "\x1b[2J\n", "a" * 1000, b"", b"\0", b"\xff" * 7, b"\0" * 16]
NESTS = [None, True, False, [], [0], [1.0] * 2, [1e308] * 4, [math.nan] * 4, [[]] * 4, {}, {"a": 1}, [0] * 3000]
EXTENSIONS = [msgpack.Timestamp(1, 1), msgpack.ExtType(5, b"x" * 8)]
VALUES = INTEGERS + FLOATS + NO_NUMBERS + WORDS + NESTS + EXTENSIONS

SIZES = [(32, 24), (32, 24), (48, 8), (2, 2), (2, 64), (64, 2), (3, 5), (320, 240)]
RANGES = [1.0, 2.5, 6.0, math.inf, math.nan, 0.0, 1e-45, 3.4e38]
CLEARS = [0.0, 1.0, 6.0, 1e-45, 3.4e38]
EVIDENCE = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, -7.0, 1e30]
LARGEST = (2048, 1024)  # [px] that are taken
INCREMENTS = [*[0.01] * 12, 1e-3, 1e-6, 1e-9, 5e-324, 6.28, 1e300]
STARTS = [*[-0.5] * 12, 0.0, 3.0, -math.pi, 6.2, 12.0, 1e17, 1e300]


class Case(NamedTuple):
    kind: type[Message]
    payload: bytes


def cases(seed: int, count: int) -> Iterator[Case]:
    """`count` messages of all kinds, half of them depth images and scans."""
    dice = random.Random(seed)
    for _ in range(count):
        kind = dice.choice(KINDS)
        yield Case(kind, payload(dice, _mutated(dice, good(dice, kind))))


def good(dice: random.Random, kind: type[Message]) -> Fields:
    """The fields of a message that is right in form, though its camera or its beams may be odd."""
    if kind is DepthImage:
        return _image(dice) if dice.random() < 0.99 else _air(dice)
    return _scan(dice) if kind is LaserScan else _plain(kind) | {"stamp": time.time_ns()}


def _image(dice: random.Random) -> Fields:
    width, height = dice.choice(SIZES)
    seed = dice.randrange(2**32)
    pixels = np.random.default_rng(seed).choice(np.array([0, 700, 1500, 4000, 65535], np.uint16), (height, width))
    roll, pitch = dice.uniform(-3.2, 3.2), dice.choice([0.0, 0.3, dice.uniform(-2, 2)])
    up = [-math.sin(roll) * math.cos(pitch), -math.cos(roll) * math.cos(pitch), -math.sin(pitch)]
    encoding, focal = dice.choice(ENCODINGS), dice.choice([0.1, 0.9, 0.9, 1.2, 100.0])
    return {
        "seq": dice.randrange(2**20),
        "stamp": time.time_ns(),
        "frame": "somewhere",
        "width": width,
        "height": height,
        "encoding": encoding,
        "data": encode(pixels, encoding),
        "intrinsics": [width * focal, height * focal, dice.uniform(-width, 2 * width), dice.uniform(-1, 2) * height],
        "range": [dice.choice([0.0, 0.5, 1e-9]), dice.choice([*[4.5] * 6, 0.01, 70.0, 1e3, 1e30, 1e308])],
        "floor": [*up, dice.choice([*[0.3] * 6, 1e-300, 1e-3, 20.0])],
    }


def _air(dice: random.Random) -> Fields:
    """An image of millions of pixels in a few hundred bytes."""
    return air(dice, *dice.choice([(2, 2**20), (2**20, 2), LARGEST, (4096, 512), (4096, 4096), (2**16, 2**16)]))


def air(dice: random.Random, width: int, height: int) -> Fields:
    """An image of this size in a few hundred bytes, with nothing in it."""
    claimed = zstandard.ZstdCompressor().compress(bytes(2 * min(width * height, 2**22)))
    image = {"width": width, "height": height, "encoding": LEVELS, "data": b"\1\0\0\0" + claimed, "range": [0.5, 4.5]}
    focal = [float(width), float(height), width / 2, height / 2]
    return _image(dice) | image | {"intrinsics": focal, "floor": [0.0, -1.0, 0.0, 0.3]}


def _scan(dice: random.Random) -> Fields:
    beams, step, start = dice.choice([1, 2, 2, 3, 16, 64, 200, 640]), dice.choice(INCREMENTS), dice.choice(STARTS)
    return {
        "seq": dice.randrange(2**20),
        "stamp": dice.choice([time.time_ns(), time.time_ns(), 0, 2**63 - 1]),
        "frame": "camera_footprint",
        "angle_min": start,
        "angle_max": start + (beams - 1) * step,
        "angle_increment": step,
        "time_increment": 0.0,
        "scan_time": 0.033,
        "range_min": 0.0,
        "range_max": dice.choice([*[10.0] * 6, 0.1, 1e5, 1e-300, 1e300]),
        "ranges": _floats(dice, beams, RANGES),
        "intensities": dice.choice([b"", _floats(dice, beams, EVIDENCE)]),
        "clear": dice.choice([b"", _floats(dice, beams, CLEARS)]),
    }


def _floats(dice: random.Random, count: int, values: list[float]) -> bytes:
    return np.array(dice.choices(values, k=count), "<f4").tobytes()


def _plain(kind: type[Message]) -> Fields:
    """The other kinds, without their stamp."""
    flags, pose, still = [False] * 3, [0.0, 0.0, 0.0], [0.0, 0.0]
    state = {"bumpers": flags, "cliffs": flags, "buttons": flags, "wheel_drops": flags[:2], "overcurrents": flags[:2]}
    state |= {"cliff_counts": [1, 2, 3], "currents": [0.1, 0.1], "battery_voltage": 15.0, "battery_percent": 50.0}
    state |= {"charger": "unknown", "dock_ir": [0, 0, 0], "digital_inputs": [True] * 4, "analog_inputs": [0.0] * 4}
    move = {"frame": "odom", "child_frame": "base_link", "pose": pose, "twist": [0.1, 0.2]}
    service = {"service": "a", "version": "1", "state": "working", "pid": 1, "uptime": 1.0, "rate": 30.0}
    gyro = {"frame": "gyro_link", "heading": 0.0, "heading_rate": 0.0, "sample_stamps": [1]}
    grid = {"frame": "map", "resolution": 0.05, "width": 4, "height": 4, "origin": pose, "data": bytes(16)}
    plain: dict[type[Message], Fields] = {
        Velocity: {"linear": 0.2, "angular": 0.1, "source": "hostile", "priority": 0},
        Odometry: move | {"pose_covariance": [0.0] * 9, "twist_covariance": [0.0] * 9},
        BaseState: state,
        Imu: gyro | {"angular_velocities": bytes(12)},
        SafetyState: {"rule": "free", "distance": -1.0, "asked": still, "allowed": still, "latched": False, "note": ""},
        ServiceStatus: service | {"latency": [0.1, 0.2], "counts": {"received": 1}, "note": ""},
        OccupancyGrid: grid,
        Pose2D: {"frame": "map", "pose": pose},
    }
    return plain[kind]


OTHERS = [Odometry, BaseState, Imu, SafetyState, ServiceStatus, OccupancyGrid, Pose2D]
KINDS: list[type[Message]] = [*[DepthImage] * 4, *[LaserScan] * 5, *[Velocity] * 2, *OTHERS]


def _value(dice: random.Random, depth: int = 0) -> Any:
    """Anything that msgpack can carry."""
    chance = dice.random()
    if chance < 0.85 or depth > 3:
        return dice.choice(VALUES)
    if chance < 0.93:
        return [_value(dice, depth + 1) for _ in range(dice.randrange(6))]
    return {dice.choice(["a", "é", "", b"k"]): _value(dice, depth + 1) for _ in range(dice.randrange(4))}


def _mutated(dice: random.Random, fields: Fields) -> Fields:
    """The fields with up to three of them wrong."""
    for _ in range(dice.choice([0, 0, 0, 0, 1, 1, 1, 2, 3])):
        name = dice.choice(list(fields))
        value, chance = fields[name], dice.random()
        if chance < 0.1:
            del fields[name]
        elif isinstance(value, list) and value and chance < 0.6:
            place = dice.randrange(len(value))
            fields[name] = [*value[:place], _value(dice), *value[place + 1 :]]
        elif isinstance(value, bytes) and value and chance < 0.6:
            fields[name] = _torn(dice, value)
        elif isinstance(value, int | float) and chance < 0.5:
            fields[name] = value * dice.choice([-1, 0, 2, 3])
        else:
            fields[name] = _value(dice)
    return fields


def _torn(dice: random.Random, data: bytes) -> bytes:
    """Some bytes changed, and sometimes the end cut off."""
    torn = bytearray(data)
    for _ in range(dice.choice([1, 1, 4])):
        torn[dice.randrange(len(torn))] = dice.choice([0xC1, 0xC6, 0xDD, 0xDF, 0xFF, dice.randrange(256)])
    return bytes(torn[: dice.randrange(len(torn) + 1)] if dice.random() < 0.3 else torn)


def payload(dice: random.Random, fields: Fields) -> bytes:
    """The msgpack of the fields, as far as there is one, and sometimes torn, nested or blown up."""
    try:
        packed: bytes = msgpack.packb(fields)
    except (OverflowError, ValueError):  # a number of more than 64 bits
        packed = b"\x81"
    chance = dice.random()
    if chance < 0.1:
        return _torn(dice, packed)
    if chance < 0.12:
        return packed + b"\xc0" * dice.randrange(1, 5)
    if chance < 0.14:
        return b"\x91" * dice.choice([10, 511, 1024, 5000]) + packed
    if chance < 0.145:
        return b"\x81\xa1a\xdd" + struct.pack(">I", 1_000_000) + b"\x90" * 1_000_000
    return dice.randbytes(dice.randrange(200)) if chance < 0.155 else packed
