"""The wheels and the floor below them."""

import math
import random
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from cliffscan.simulator.kobuki.kinematics import REST, TRACK, Wheels, clamp


class Pose(NamedTuple):
    """Where the base truly is: x, y [m], theta [rad] counter-clockwise from x, not wrapped."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0


class Rates(NamedTuple):
    """How fast the base turns about its own axes [rad/s]: x forward, y left, z up."""

    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0


class Drive(Protocol):
    """What the firmware drives: wheels with encoders, under a body with a gyro.

    A physics simulator puts its own in the place of `RampedWheels`; where its world moves by itself, `step` is empty.
    """

    @property
    def travelled(self) -> Wheels:
        """Distance each rim has turned [m], slipping or not: what the encoders see."""

    @property
    def speeds(self) -> Wheels:
        """Speed of each rim [m/s]."""

    @property
    def pose(self) -> Pose:
        """The true pose; its theta is what the gyro integrates."""

    @property
    def rates(self) -> Rates:
        """The true turning rates [rad/s]."""

    def command(self, speeds: Wheels) -> None:
        """Make for these speeds [m/s] from now on."""

    def release(self) -> None:
        """Motors off, until the next command."""

    def step(self, dt: float) -> None:
        """Let time pass [s]."""


@dataclass(frozen=True)
class WheelModel:
    """How wheels follow their set speed and how they grip. Raises ValueError for a value that means nothing.

    The real firmware has no speed profile: it goes for a new set speed with what its motors give, hard enough to lift
    the front (github yujinrobot/kobuki issues 111, 177, 355). Nobody has published that figure; 1.0 m/s² is chosen on
    the slow side, so that a driver that counts on it to brake stops a real base in time as well. The ramps of ROS's
    driver, 0.5 and 0.6 m/s², are followed exactly.
    """

    acceleration: float = 1.0  # [m/s²] of a rim
    deceleration: float = 1.0  # [m/s²] of a rim, with motors off as well: the gears do not coast
    slip: Wheels = REST  # share of a rim's way that does not move the base
    noise: float = 0.0  # [√m] standard deviation of a wheel's way over the floor [m] after 1 m; grows with its root

    def __post_init__(self) -> None:
        for name in ("acceleration", "deceleration"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} of {getattr(self, name)} m/s², expected more than 0")
        if not 0.0 <= self.noise < math.inf:
            raise ValueError(f"noise of {self.noise}, expected 0 or more")
        if not all(-1.0 <= slip <= 1.0 for slip in self.slip):
            raise ValueError(f"slip of {self.slip.left}, {self.slip.right}, expected -1 to 1")

    def ramp(self, speed: float, target: float, dt: float) -> float:
        """The speed of a rim that makes for a target, a while [s] later. All speeds in m/s."""
        slowing = speed * (target - speed) < 0.0
        rate = self.deceleration if slowing else self.acceleration
        return speed + clamp(target - speed, rate * dt)

    def error(self, way: float, rng: random.Random) -> float:
        """By how much [m] a wheel's way over the floor differs by chance from that [m] of its rim."""
        return self.noise * math.sqrt(abs(way)) * rng.gauss(0.0, 1.0) if self.noise else 0.0


class RampedWheels:
    """Wheels on a flat floor that change speed at a limited rate and slip as their model says: a `Drive`."""

    def __init__(self, model: WheelModel | None = None, seed: int = 0) -> None:
        self.model = model or WheelModel()
        self.travelled = REST
        self.speeds = REST
        self.pose = Pose()
        self.rates = Rates()
        self._target = REST
        self._random = random.Random(seed)

    def command(self, speeds: Wheels) -> None:
        """Make for these speeds [m/s] from now on."""
        self._target = speeds

    def release(self) -> None:
        """Motors off: the wheels run down."""
        self._target = REST

    def step(self, dt: float) -> None:
        """Let a moment pass [s], short against the time in which speeds change."""
        before, target = self.speeds, self._target
        ramp = self.model.ramp
        self.speeds = Wheels(ramp(before.left, target.left, dt), ramp(before.right, target.right, dt))
        left = dt * (before.left + self.speeds.left) / 2
        right = dt * (before.right + self.speeds.right) / 2
        self.travelled = Wheels(self.travelled.left + left, self.travelled.right + right)
        self._move(self._grip(left, self.model.slip.left), self._grip(right, self.model.slip.right), dt)

    def _grip(self, way: float, slip: float) -> float:
        """How far a wheel gets over the floor [m] while its rim turns by a way [m]."""
        return way * (1.0 - slip) + self.model.error(way, self._random)

    def _move(self, left: float, right: float, dt: float) -> None:
        turn = (right - left) / TRACK
        middle = self.pose.theta + turn / 2
        way = (left + right) / 2
        x, y = self.pose.x + way * math.cos(middle), self.pose.y + way * math.sin(middle)
        self.pose = Pose(x, y, self.pose.theta + turn)
        self.rates = Rates(yaw=turn / dt)
