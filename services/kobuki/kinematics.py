"""The Kobuki's wheels: metres in ticks, and a velocity as the speed and radius that the base understands.

Source: Kobuki protocol and driver.
"""

import math

WHEEL_SEPARATION = 0.23  # [m]
METRES_PER_TICK = 0.0000852920904977
NO_TURN = 1e-4  # [rad/s], a slower turn is a straight line
NO_SPEED = 1e-4  # [m/s], a slower speed is a turn on the spot
ON_THE_SPOT = 1  # [mm], the radius that means it
INT16 = (-0x8000, 0x7FFF)


def speed_and_radius(linear: float, angular: float) -> tuple[int, int]:
    """The speed [mm/s] of the outer wheel and the radius [mm] of the arc, for m/s and rad/s.

    Radius 0 is a straight line, radius 1 a turn on the spot, positive to the left. An arc of less than 2 mm to the
    right would come out as radius -1, which the base does not define; it becomes a turn on the spot.
    Raises ValueError where a velocity is no number.
    """
    if not (math.isfinite(linear) and math.isfinite(angular)):
        raise ValueError(f"velocity ({linear} m/s, {angular} rad/s), expected finite numbers")
    half = 1000.0 * WHEEL_SEPARATION / 2.0
    if abs(angular) < NO_TURN:
        return _int16(1000.0 * linear), 0
    radius = 1000.0 * linear / angular
    if abs(linear) < NO_SPEED or abs(radius) <= ON_THE_SPOT or _int16(radius) == -ON_THE_SPOT:
        return _int16(half * angular), ON_THE_SPOT
    return _int16((radius + math.copysign(half, radius)) * angular), _int16(radius)


def _int16(number: float) -> int:
    """The nearest number towards zero that 16 bits hold."""
    low, high = INT16
    return int(min(max(number, low), high))
