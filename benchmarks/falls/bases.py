"""The robots that wander: a base, what drives it safely, and what its perception and its driver must know of it."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Literal, NamedTuple, Protocol

from benchmarks.falls.perception import FRAME
from cliffscan.common.contract.base_messages import Odometry, Velocity
from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.description import CameraDescription, Place
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.message_gate import Warn
from cliffscan.safety.rules import Decision
from cliffscan.safety.scan_claims import View
from cliffscan.services.gate.config import GateConfig
from cliffscan.services.gate.controller import GateController
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.controller import BaseController
from cliffscan.services.kobuki.protocol.sensors import Core
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.perception.perceive import Settings
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.simulator.differential import LARGE, DifferentialRobot
from cliffscan.simulator.kinect import Millimetres
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.world import Pose, World

Base = Literal["turtlebot2", "differential_large"]

SECOND = 1_000_000_000  # [ns]
TICK = 0.01  # [s]
ENCODER_NOISE = 0.003  # [√m] 3 mm after 1 m, on top of how the wheels slip
WIDE = 70.0  # [deg] field of view of the scans
ODOMETRY_TICKS = 2  # between two messages of odometry
COVARIANCE = [0.0] * 9


class Size(NamedTuple):
    """What a driver and the reckoning must know of a robot."""

    radius: float  # [m] of a disc that it needs at the least
    around: float  # [m] of a thing where the robot's middle cannot be; with 0.22 m, passages of 0.60 m stay open
    ahead: float  # [m] of the middle of a robot that is held, where its middle cannot get to
    view: View


TURTLEBOT_2_SIZE = Size(0.18, 0.22, 0.20, View.undescribed())


class Simulated(Protocol):
    """A robot in the simulator, as all of them are."""

    world: World
    camera: Camera

    @property
    def time(self) -> float:
        """[s] that has passed."""

    @property
    def pose(self) -> Pose:
        """Where the robot truly is."""

    @property
    def fallen(self) -> bool:
        """Whether it fell."""

    def frame(self) -> Millimetres:
        """What the camera sees."""


class Controller(Protocol):
    """The code that drives a base safely."""

    @property
    def decision(self) -> Decision:
        """What became of the last command."""

    def scan(self, message: LaserScan, stamp: int, now: float) -> None:
        """A fused scan came."""

    def command(self, message: Velocity, stamp: int, now: float) -> None:
        """A command came."""


class Rig(ABC):
    """A simulated robot with its gate."""

    settings: Settings  # of perception
    size: Size

    def __init__(self, robot: Simulated, controller: Controller) -> None:
        self._simulated, self._gate = robot, controller
        self.world, self.camera = robot.world, robot.camera

    @property
    def time(self) -> float:
        """[s] that has passed."""
        return self._simulated.time

    @property
    def pose(self) -> Pose:
        """Where the robot truly is."""
        return self._simulated.pose

    @property
    def fallen(self) -> bool:
        """Whether it fell."""
        return self._simulated.fallen

    @property
    def decision(self) -> Decision:
        """What the gate made of the last command."""
        return self._gate.decision

    def frame(self) -> Millimetres:
        """What the camera sees."""
        return self._simulated.frame()

    def see(self, scan: LaserScan) -> None:
        """The gate receives a fused scan."""
        self._gate.scan(scan, _stamp(self.time), self.time)

    def ask(self, linear: float, angular: float) -> None:
        """The gate receives a command [m/s, rad/s]."""
        stamp = _stamp(self.time)
        self._gate.command(Velocity(stamp=stamp, linear=linear, angular=angular), stamp, self.time)

    @property
    @abstractmethod
    def bumps(self) -> int:
        """How often something began to push it."""

    @property
    @abstractmethod
    def cliff(self) -> bool:
        """Whether a cliff sensor fires or, without one, a wheel or a caster has no floor below it."""

    @abstractmethod
    def step(self) -> None:
        """Let TICK pass, and have the gate read what the base reports."""

    @abstractmethod
    def finish(self) -> None:
        """Time passes for the gate; what it decided goes to the base."""


class TurtleBot2(Rig):
    """A TurtleBot 2 behind the driver of its base."""

    settings, size = Settings(), TURTLEBOT_2_SIZE

    def __init__(self, world: str, seed: int, warn: Warn) -> None:
        self._robot = RobotSimulation(world, seed=seed, wheels=WheelModel(noise=ENCODER_NOISE))
        self._controller = BaseController(KobukiConfig(), warn)
        super().__init__(self._robot, self._controller)
        self._controller.connect(simulated=True, now=0.0)
        self._controller.describe(CameraDescription.of(self.camera, FRAME, simulated=True))
        self._core: Core | None = None
        self._to_base = b""

    @property
    def bumps(self) -> int:
        """See Rig."""
        return self._robot.base.bumps

    @property
    def cliff(self) -> bool:
        """See Rig."""
        return bool(self._core and self._core.cliff)

    def step(self) -> None:
        """See Rig."""
        said = self._robot.step(TICK, self._to_base)
        for report in self._controller.receive(said, _stamp(self.time), self.time):
            self._core = report.core
        self._controller.caught_up()

    def finish(self) -> None:
        """See Rig."""
        self._controller.tick(self.time)
        self._to_base = b"".join(output.data for output in self._controller.take_outputs())


class Differential(Rig):
    """A robot of another make behind the gate for any base: 0.70 m x 0.50 m, no bumper, no cliff sensor, no gyro.

    Its limits are the simulator's with some room, as `cliffscan calibrate --base` finds them.
    """

    settings = Settings(NegativeConfig(field_of_view=WIDE), PositiveConfig(field_of_view=WIDE))

    def __init__(self, world: str, seed: int, warn: Warn) -> None:
        self._robot = DifferentialRobot(LARGE, world, seed=seed)
        config = GateConfig(
            simulated=True,
            footprint=LARGE.footprint,
            deceleration=0.7,
            angular_deceleration=180.0,
            reaction=0.2,
            start_free=0.75,
        )
        self._controller = GateController(config, warn)
        super().__init__(self._robot, self._controller)
        described = CameraDescription.of(self.camera, FRAME, simulated=True, place=Place(LARGE.camera_x, 0.0, 0.0))
        self.size = Size(0.25, 0.33, 0.40, View.of(described))
        self._controller.describe(described)
        self._ticks = 0

    @property
    def bumps(self) -> int:
        """See Rig."""
        return self._robot.bumps

    @property
    def cliff(self) -> bool:
        """See Rig."""
        return self._robot.over_nothing

    def step(self) -> None:
        """See Rig."""
        taken, pose = self.time, self._robot.odometry  # a message is a tick old when it comes
        self._robot.step(TICK)
        self._ticks += 1
        if self._ticks % ODOMETRY_TICKS == 0:
            message = Odometry.model_construct(
                stamp=_stamp(taken),
                frame="odom",
                child_frame="base_link",
                pose=pose,
                twist=(0.0, 0.0),
                pose_covariance=COVARIANCE,
                twist_covariance=COVARIANCE,
            )
            self._controller.odometry(message, _stamp(self.time), self.time)

    def finish(self) -> None:
        """See Rig."""
        self._controller.tick(self.time)
        for velocity in self._controller.take_outputs():
            self._robot.command(*velocity)


RIGS: dict[Base, Callable[[str, int, Warn], Rig]] = {"turtlebot2": TurtleBot2, "differential_large": Differential}


def _stamp(seconds: float) -> int:
    """[ns]"""
    return round(seconds * SECOND)
