"""How far the robot's disc can go along an arc before it touches something, and how fast it may go until then."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STRAIGHT = 1e-6  # [1/m] curvature below which an arc is a line


class Contact(NamedTuple):
    """Where an arc ends."""

    distance: float  # [m] to drive until then
    point: int  # number of the point that is touched


NO_CONTACT = Contact(math.inf, -1)


def first_contact(points: Floats, side: int, curvature: float, radius: float, clearance: float) -> Contact:
    """How far the robot can drive until its disc of `radius` [m] touches the first of `points`.

    points: (2, n) [m] in the robot's frame, x forward and y left. side: 1 forward, -1 backward. curvature [1/m]:
    angular by linear velocity. What the arc passes at `clearance` [m] or more, `radius` at most, is not in the way. A
    point that the disc covers already may not come nearer than it is: it is touched at once if the motion approaches
    it, and if it leads away, when it has led back.
    """
    x, y = side * points[0], points[1]
    if abs(curvature) < STRAIGHT:
        return _along_line(x, y, radius, clearance)
    return _along_arc(x, math.copysign(1.0, curvature) * y, 1.0 / abs(curvature), radius, clearance)


def safe_speed(distance: float, deceleration: float, latency: float) -> float:
    """The highest speed [m/s] from which the robot stops within `distance` [m].

    It goes on for `latency` [s] before it begins to brake at `deceleration` [m/s²]: v·latency + v²/(2·deceleration).
    """
    return deceleration * (math.hypot(latency, math.sqrt(2.0 * max(distance, 0.0) / deceleration)) - latency)


def _along_line(x: Floats, y: Floats, radius: float, clearance: float) -> Contact:
    met = np.flatnonzero((x > 0.0) & (np.abs(y) < clearance))
    return _nearest(x[met] - np.sqrt(radius**2 - y[met] ** 2), met)


def _along_arc(x: Floats, y: Floats, turn: float, radius: float, clearance: float) -> Contact:
    """On a circle of radius `turn` [m] to the left: the robot touches a point `reach` [rad] before it passes it."""
    left = turn - y
    square = x * x + left * left  # of the distance from the circle's middle
    met = np.flatnonzero((square < (turn + clearance) ** 2) & (square > max(turn - clearance, 0.0) ** 2))
    x, left, from_centre = x[met], left[met], np.sqrt(square[met])
    passed = np.arctan2(x, left) % (2.0 * math.pi)
    near = np.minimum(x * x + (turn - left) ** 2, radius**2)
    cosine = (turn**2 + from_centre**2 - near) / np.maximum(2.0 * turn * from_centre, 1e-12)
    reach = np.arccos(np.minimum(np.maximum(cosine, -1.0), 1.0))
    return _nearest(turn * (passed - reach), met)


def _nearest(distances: Floats, met: NDArray[np.int64]) -> Contact:
    """The least of the distances [m], to the points of these numbers."""
    if not met.size:
        return NO_CONTACT
    first = int(distances.argmin())
    return Contact(max(float(distances[first]), 0.0), int(met[first]))
