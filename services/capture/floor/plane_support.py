"""How far each beam sees a plane as floor, from the robot outward; its slow twin is in tests/unit/capture.

     ring   0  1  2  3  4  5  6  7        f: on the plane, by FLOOR_SIGMAS; x: off it, a stray; blank: nothing seen
     beam   f  f  x  f     f  x  f        The first stray may be a speckle; the second ends the floor:
            |-----------------|           rings 0 to 5 are the run, those of them that are f its floor.

A beam's rings are the bits of one number, ring 0 the lowest, so that the first ray off the floor is a subtraction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cliffscan.services.capture.floor.rays import Flags, Floats, Singles

Bits = NDArray[np.uint64]

FLOOR_SIGMAS = 3.0  # of noise off a plane, beyond which a ray does not see it
LIKELY_SIGMAS, CLOSE_SIGMAS = 2.0, 1.0  # within which a ray supports the plane, and within which it counts twice
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
    floor = before_second(bits(miss > FLOOR_SIGMAS * noise_scale))
    close, likely = bits(miss <= CLOSE_SIGMAS * noise_scale) & floor, bits(miss <= LIKELY_SIGMAS * noise_scale) & floor
    return np.asarray((np.bitwise_count(close) + np.bitwise_count(likely)).sum(axis=-1, dtype=np.int64))


def run(miss: Singles, noise_scale: float, short: int = 0) -> Flags:
    """The rays of a plane's floor: (..., beams, rings); `short` rings fewer before each end."""
    seen = bits(miss <= FLOOR_SIGMAS * noise_scale)
    return flags(seen & (before_second(bits(miss > FLOOR_SIGMAS * noise_scale)) >> np.uint64(short)))
