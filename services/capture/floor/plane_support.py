"""Which rays see a plane as floor that begins before the robot: each beam is followed outward until its floor ends.

A beam's rings are the bits of one number, ring 0 the lowest, so that the first ray off the floor is a subtraction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cliffscan.services.capture.floor.rays import Flags, Floats, Singles

Bits = NDArray[np.uint64]

CLOSE, LIKELY, ODD = 1.0, 2.0, 3.0  # noise sigmas off a plane: good evidence, evidence; and beyond it is no floor
ONE = np.uint64(1)


def misses(inverse: Singles, slopes: Singles, planes: Floats) -> Singles:
    """How far each ray is off each plane, in noise sigmas: (planes, beams, rings); nan where nothing was seen."""
    expected: Singles = planes.astype(np.float32) @ slopes.reshape(3, -1)
    expected -= inverse.reshape(-1)
    np.abs(expected, out=expected)
    return expected.reshape(-1, *inverse.shape)


def bits(flags: Flags) -> Bits:
    """(..., rings) as (...) numbers."""
    numbers: Bits = np.packbits(flags, axis=-1, bitorder="little").view("<u8")[..., 0]
    return numbers


def flags(numbers: Bits) -> Flags:
    """(...) numbers as (..., rings)."""
    octets = numbers.astype("<u8")[..., None].view(np.uint8)
    return np.unpackbits(octets, axis=-1, bitorder="little").view(np.bool_)


def before_second(strays: Bits) -> Bits:
    """The rings nearer than the second stray of each beam; one may be a speckle. All rings where there is none."""
    second = strays & (strays - ONE)
    return (second & (~second + ONE)) - ONE


def support(miss: Singles, noise_scale: float) -> NDArray[np.int64]:
    """How much floor that begins before the robot each plane explains: (planes,)."""
    floor = before_second(bits(miss > ODD * noise_scale))
    close, likely = bits(miss <= CLOSE * noise_scale) & floor, bits(miss <= LIKELY * noise_scale) & floor
    return np.asarray((np.bitwise_count(close) + np.bitwise_count(likely)).sum(axis=-1, dtype=np.int64))


def run(miss: Singles, noise_scale: float, short: int = 0) -> Flags:
    """The rays of a plane's floor: (..., beams, rings); `short` rings fewer before each end."""
    seen = bits(miss <= ODD * noise_scale)
    return flags(seen & (before_second(bits(miss > ODD * noise_scale)) >> np.uint64(short)))
