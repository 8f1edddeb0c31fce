"""The firmware's drive, with MuJoCo's world in the place of the flat floor."""

import math
import random

from cliffscan.simulator.body import STEP, Body
from cliffscan.simulator.kobuki.drive import Pose, Rates, WheelModel
from cliffscan.simulator.kobuki.kinematics import REST, Wheels
from cliffscan.simulator.kobuki.ticker import SECOND, nanoseconds


class PhysicalWheels:
    """The motors, encoders and gyro of a body: a `Drive`. The world moves while `step` lets time pass.

    A wheel slips as its contact with the floor has it. The model's noise is added to what the encoders tell, as slip
    that the contacts do not have. Raises ValueError for a model with a share of slip.
    """

    def __init__(self, body: Body, model: WheelModel | None = None, seed: int = 0) -> None:
        self.body = body
        self.model = model or WheelModel()
        if self.model.slip != REST:
            raise ValueError("in a physical world wheels slip as their contacts do; only noise can be added")
        self.travelled = REST
        self.time = 0  # [ns] that has passed in the world
        self._target = self._set = REST  # [m/s] commanded, and on the way there
        self._owed = 0  # [ns] too short for a step
        self._random = random.Random(seed)
        self.placed()

    def placed(self) -> None:
        """Take note that the body was put elsewhere, which turns no wheel."""
        self._rims = self.body.rims
        self._theta = self.body.pose.yaw

    @property
    def speeds(self) -> Wheels:
        """Speed of each rim [m/s]."""
        return self.body.rim_speeds

    @property
    def pose(self) -> Pose:
        """The true pose; its theta [rad] is not wrapped."""
        x, y, _ = self.body.pose
        return Pose(x, y, self._theta)

    @property
    def rates(self) -> Rates:
        """The true turning rates [rad/s]."""
        return Rates(*self.body.rates)

    def command(self, speeds: Wheels) -> None:
        """Make for these speeds [m/s] from now on."""
        self._target = speeds

    def release(self) -> None:
        """Motors off: the wheels run down."""
        self._target = REST

    def step(self, dt: float) -> None:
        """Let time pass [s] in the world, in whole steps; what is left of it passes the next time."""
        self._owed += nanoseconds(dt)
        count, self._owed = divmod(self._owed, STEP)
        for _ in range(count):
            ramped = (self.model.ramp(*pair, STEP / SECOND) for pair in zip(self._set, self._target, strict=True))
            self._set = Wheels(*ramped)
            self.body.step(self._set)
        self.time += count * STEP
        self._read()

    def _read(self) -> None:
        """Turn the encoders and the gyro's heading as far as the world has moved."""
        self._theta += math.remainder(self.body.pose.yaw - self._theta, math.tau)
        before, self._rims = self._rims, self.body.rims
        ways = (now - earlier for now, earlier in zip(self._rims, before, strict=True))
        left, right = (way + self.model.error(way, self._random) for way in ways)  # what the encoders tell
        self.travelled = Wheels(self.travelled.left + left, self.travelled.right + right)
