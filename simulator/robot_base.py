"""A base whose wheels stand in a world: what it feels there goes to its sensors."""

import math

from cliffscan.simulator.body import Body
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.kobuki.firmware import DEAD_TIME, Firmware
from cliffscan.simulator.kobuki.line import Line
from cliffscan.simulator.kobuki.ticker import SECOND
from cliffscan.simulator.senses import Reporter, feel
from cliffscan.simulator.wheels import PhysicalWheels
from cliffscan.simulator.world import Pose

FEEL_PERIOD = 0.01  # [s] the longest time between two looks at the sensors
FALLEN_TILT = math.radians(20.0)  # more than any ramp and nod
FALLEN_DEPTH = 0.04  # [m] below the floor


class RobotBase(Base):
    """The base of a robot with a body: its `step` is what lets time pass in the body's world.

    wheels: how the motors follow a command; dead_time: [s] from a command to the motors; seed: of slip noise, garbage.
    """

    def __init__(
        self, body: Body, wheels: WheelModel | None = None, dead_time: float = DEAD_TIME, seed: int = 0
    ) -> None:
        self.body = body
        self.wheels = PhysicalWheels(body, wheels, seed)
        super().__init__(Firmware(self.wheels, dead_time=dead_time), Line(seed))
        self.fallen = False  # from the moment it fell until it is placed again
        self.bumped = False  # whether the hull was pushed from any side since the last step began
        self.bumps = 0  # how often a push has begun
        self._pushed = False
        self._reporter = Reporter()

    @property
    def time(self) -> float:
        """Time [s] that has passed in the world."""
        return self.wheels.time / SECOND

    def place(self, pose: Pose) -> None:
        """Put the robot down elsewhere, at rest and unhurt."""
        self.body.place(pose)
        self.wheels.placed()
        self.fallen = self.bumped = self._pushed = False

    def step(self, dt: float) -> list[bytes]:
        """Let time pass [s]; what the driver gets to read, piece by piece."""
        self.bumped = False
        pieces = []
        while dt > 0.0:
            part = min(dt, FEEL_PERIOD)
            pieces += super().step(part)
            self._feel()
            dt -= part
        return pieces

    def _feel(self) -> None:
        felt = feel(self.body)
        self._reporter.report(felt, self.firmware.sensors)
        self.bumps += felt.bumped and not self._pushed
        self.bumped |= felt.bumped
        self._pushed = felt.bumped
        self.fallen |= self.body.tilt > FALLEN_TILT or float(self.body.position[2]) < -FALLEN_DEPTH
