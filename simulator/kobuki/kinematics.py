"""The base's measures: from a command to wheel speeds, from wheel travel to encoder ticks."""

import math
from typing import NamedTuple

TRACK = 0.23  # [m] between the wheels
METRES_PER_TICK = 0.0000852920904977
MAX_SPEED = 0.70  # [m/s]
MAX_TURN = math.radians(180.0)  # [rad/s]


class Wheels(NamedTuple):
    """Something of each wheel: speeds [m/s], distances [m], shares."""

    left: float
    right: float


REST = Wheels(0.0, 0.0)


def wheel_speeds(speed: int, radius: int) -> Wheels:
    """Speeds of the rims [m/s] for a command in mm/s and mm, within what the base can do.

    On an arc `speed` is the outer wheel's. A positive radius has its centre on the left. Radius 1 turns on the spot,
    to the left for a positive speed; -1 is not defined by the protocol and is taken for its mirror image.
    """
    outer = speed / 1000.0
    if radius == 0:
        return limited(Wheels(outer, outer))
    centre = abs(radius) / 1000.0 if abs(radius) > 1 else 0.0
    inner = outer * (centre - TRACK / 2) / (centre + TRACK / 2)
    return limited(Wheels(inner, outer) if radius > 0 else Wheels(outer, inner))


def limited(speeds: Wheels) -> Wheels:
    """The nearest speeds [m/s] at which the base neither drives nor turns faster than it can."""
    forward = clamp((speeds.left + speeds.right) / 2, MAX_SPEED)
    turn = clamp((speeds.right - speeds.left) / TRACK, MAX_TURN)
    return Wheels(forward - turn * TRACK / 2, forward + turn * TRACK / 2)


def ticks(distance: float) -> int:
    """What an encoder shows after its rim went a distance [m]: 0 to 65535, then again from 0."""
    return math.floor(distance / METRES_PER_TICK) & 0xFFFF


def clamp(value: float, limit: float) -> float:
    """The value, or the nearer of -limit and +limit."""
    return max(-limit, min(limit, value))
