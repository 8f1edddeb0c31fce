"""A robot that is no TurtleBot, whole: a body with two driven wheels, plain motors, odometry by its wheels, a camera.

robot = DifferentialRobot(LARGE, "landing", seed=1)
robot.command(0.3, 0.0)
pose = robot.step(0.02)
"""

import math
from typing import NamedTuple

from cliffscan.common.contract.camera import Camera
from cliffscan.simulator.body import Body, BodyModel
from cliffscan.simulator.kinect import Millimetres
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.kobuki.kinematics import REST, Wheels
from cliffscan.simulator.kobuki.motors import Motors
from cliffscan.simulator.kobuki.ticker import SECOND, nanoseconds
from cliffscan.simulator.mounted_camera import MountedCamera
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import sensor_camera
from cliffscan.simulator.wheels import PhysicalWheels
from cliffscan.simulator.world import START, Pose, World

TIMEOUT = 0.3  # [s] without a command after which the base stands
FALLEN_TILT = math.radians(10.0)  # long and low: it nods by less, and lies on its belly sooner, than a TurtleBot 2
NO_FLOOR = 0.06  # [m] below a wheel or a caster that stands on nothing


class RobotModel(NamedTuple):
    """A make of robot."""

    body: BodyModel
    footprint: tuple[tuple[float, float], ...]  # [m] corners x, y of the body
    supports: tuple[tuple[float, float], ...]  # [m] where wheels and casters touch the floor
    dead_time: float  # [s] from a command to the motors
    wheels: WheelModel
    sensor: str
    camera_x: float  # [m] ahead of the middle between the wheels
    height: float  # [m] of the camera over the floor
    pitch: float  # [rad] it looks down


LARGE = RobotModel(
    body=BodyModel("differential_large", 0.08, 0.40, ("base",)),
    footprint=((0.30, 0.25), (0.30, -0.25), (-0.40, -0.25), (-0.40, 0.25)),
    supports=((0.0, 0.20), (0.0, -0.20), (0.20, 0.17), (0.20, -0.17), (-0.30, 0.17), (-0.30, -0.17)),
    dead_time=0.12,
    wheels=WheelModel(acceleration=1.0, deceleration=0.8, noise=0.002),
    sensor="azure_kinect",
    camera_x=0.20,
    height=0.60,
    pitch=math.radians(25.0),
)


class DifferentialRobot:
    """A robot of a make in a world by name, the same for the same seed and the same calls. Time passes only in `step`.

    Raises ValueError for an unknown world.
    """

    def __init__(self, model: RobotModel, world: str, pose: Pose = START, seed: int = 0) -> None:
        self.model, self.world = model, World(world, pose)
        self.body = Body(world, pose, model.body)
        self.camera: Camera = sensor_camera(model.sensor, model.height, model.pitch)
        self._mounted = MountedCamera(self.world, self.body, self.camera, MODELS[model.sensor], model.camera_x, seed)
        self._wheels = PhysicalWheels(self.body, model.wheels, seed)
        self._motors = Motors(self._wheels, nanoseconds(model.dead_time))
        self._commanded_at = -math.inf
        self._travelled = REST
        self.odometry = (0.0, 0.0, 0.0)  # x, y [m], theta [rad] by the wheels
        self.fallen = False
        self.bumps = 0  # how often a push against the hull has begun
        self._pushed = False

    @property
    def time(self) -> float:
        """Time [s] that has passed."""
        return self._wheels.time / SECOND

    @property
    def pose(self) -> Pose:
        """Where the middle between the wheels truly is."""
        return self.body.pose

    @property
    def over_nothing(self) -> bool:
        """Whether a wheel or a caster has no floor below it."""
        return any(self.body.below((x, y, 0.03)) > NO_FLOOR + 0.03 for x, y in self.model.supports)

    def command(self, linear: float, angular: float) -> None:
        """Command the motors [m/s, rad/s]; they obey after the dead time."""
        self._commanded_at = self.time
        half = angular * self.model.body.track / 2.0
        self._motors.command(Wheels(linear - half, linear + half))

    def step(self, dt: float) -> None:
        """Let time pass [s]; a base that is not commanded any more stops."""
        if self.time - self._commanded_at > TIMEOUT:
            self._motors.command(REST)
        left = nanoseconds(dt)
        while left > 0:
            part = min(left, self._motors.until())
            self._motors.advance(part, cut=False)
            left -= part
        self._integrate()
        pushed = bool(len(self.body.contacts()))
        self.bumps += pushed and not self._pushed
        self._pushed = pushed
        self.fallen |= self.body.has_fallen(FALLEN_TILT)

    def frame(self) -> Millimetres:
        """What the sensor sees now: (rows, cols) [mm], 0 = no return."""
        return self._mounted.frame()

    def _integrate(self) -> None:
        """Follow the encoders along an arc, taken as its chord in the direction of the arc's middle."""
        before, self._travelled = self._travelled, self._wheels.travelled
        left, right = (now - then for now, then in zip(self._travelled, before, strict=True))
        x, y, theta = self.odometry
        turn, way = (right - left) / self.model.body.track, (left + right) / 2.0
        middle = theta + turn / 2.0
        heading = math.remainder(theta + turn, math.tau)
        self.odometry = (x + way * math.cos(middle), y + way * math.sin(middle), heading)
