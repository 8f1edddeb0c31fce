"""How far the robot's disc can go along an arc before it touches something, and how fast it may go until then."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STRAIGHT = 1e-6  # [1/m] curvature below which an arc is a line


def free_distance(points: Floats, linear: float, angular: float, radius: float) -> float:
    """Distance [m] the robot can drive until its disc of `radius` [m] touches the first of `points`; inf for none.

    points: (2, n) [m] in the robot's frame, x forward and y left. linear [m/s] is not 0; angular [rad/s]. A point
    that the disc covers already is touched at once if the motion approaches it, and let go if it leads away.
    """
    side = math.copysign(1.0, linear)
    x, y = side * points[0], points[1]
    covered = x * x + y * y < radius * radius
    if (covered & (x > 0.0)).any():
        return 0.0
    curvature = angular / linear
    ahead = ~covered
    distances = (
        _along_line(x[ahead], y[ahead], radius)
        if abs(curvature) < STRAIGHT
        else _along_arc(x[ahead], math.copysign(1.0, curvature) * y[ahead], 1.0 / abs(curvature), radius)
    )
    return float(distances.min(initial=math.inf))


def safe_speed(distance: float, deceleration: float, latency: float) -> float:
    """The highest speed [m/s] from which the robot stops within `distance` [m].

    It goes on for `latency` [s] before it begins to brake at `deceleration` [m/s²]: v·latency + v²/(2·deceleration).
    """
    return deceleration * (math.sqrt(latency**2 + 2.0 * max(distance, 0.0) / deceleration) - latency)


def _along_line(x: Floats, y: Floats, radius: float) -> Floats:
    met = (x > 0.0) & (np.abs(y) <= radius)
    return x[met] - np.sqrt(radius**2 - y[met] ** 2)


def _along_arc(x: Floats, y: Floats, turn: float, radius: float) -> Floats:
    """On a circle of radius `turn` [m] to the left: the robot touches a point `reach` [rad] before it passes it."""
    from_centre = np.hypot(x, turn - y)
    met = np.abs(from_centre - turn) <= radius
    x, y, from_centre = x[met], y[met], from_centre[met]
    passed = np.arctan2(x, turn - y) % (2.0 * math.pi)
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (turn**2 + from_centre**2 - radius**2) / (2.0 * turn * from_centre)
    reach = np.arccos(np.clip(np.nan_to_num(cosine, nan=-1.0, neginf=-1.0), -1.0, 1.0))
    return turn * np.maximum(passed - reach, 0.0)
