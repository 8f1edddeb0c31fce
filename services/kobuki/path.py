"""How far the robot's disc can go along an arc before it touches something, and how fast it may go until then."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STRAIGHT = 1e-6  # [1/m] curvature below which an arc is a line
SLOW = 0.05  # [m/s] at which the robot stands almost at once
BEND = 0.1  # [1/m] by which two curvatures may differ and be taken for one
FAN = 3  # arcs that stand for all between the two outermost
SHARP = 0.3  # [m] radius of a turn halfway, for the fan, between going straight and turning on the spot


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
    return deceleration * (math.hypot(latency, math.sqrt(2.0 * max(distance, 0.0) / deceleration)) - latency)


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


class Momentum:
    """What the base may still be doing: a command shows only after up to `delay` [s], and braking takes its time.

    Without this a robot could swerve at speed from an arc that was found free into something beside it, or be steered
    between two free arcs into what stands between them.
    """

    def __init__(self, delay: float, deceleration: float) -> None:
        self._delay, self._deceleration = delay, deceleration
        self.rest()

    def rest(self) -> None:
        """The base stands still."""
        self._sent: deque[_Sent] = deque([_Sent(-math.inf, 0.0, 0.0)])
        self._speeds = {1: 0.0, -1: 0.0}
        self._at = -math.inf

    def send(self, linear: float, angular: float, now: float) -> None:
        """The base is sent this velocity, [m/s] and [rad/s], at `now` [s]."""
        self._speeds = {side: self.speed(side, now) for side in (1, -1)}
        self._at = now
        self._sent.append(_Sent(now, linear, angular))
        while len(self._sent) > 1 and self._sent[1].at + self._delay < now:  # what replaced it has reached the wheels
            self._sent.popleft()

    def speed(self, side: int, now: float) -> float:
        """The highest speed [m/s], forward (side 1) or backward (-1), that the base may have at `now` [s]."""
        braked = self._speeds[side] - self._deceleration * max(now - self._at, 0.0) if self._speeds[side] else 0.0
        return max(braked, *(side * sent.linear for sent in self._sent), 0.0)

    def curvatures(self, side: int, linear: float, angular: float, now: float) -> list[float]:
        """Curvatures [1/m] the base may take, in that direction, when sent this velocity; the one asked for first."""
        speed = self.speed(side, now)
        before = [sent.angular / sent.linear for sent in self._sent if side * sent.linear > SLOW]
        after = [angular / linear] if side * linear > 0.0 else [side * angular / SLOW]
        if speed > SLOW and any(abs(each - after[0]) > BEND for each in before or [math.inf]):
            after.append(side * angular / speed)
        both = np.arctan(np.array(before + after) * SHARP)
        if both.max() - both.min() < BEND * SHARP:
            return after[:1]
        return [after[0], *(np.tan(np.linspace(both.min(), both.max(), FAN)) / SHARP).tolist()]


class _Sent(NamedTuple):
    at: float  # [s]
    linear: float
    angular: float
