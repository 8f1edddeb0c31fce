"""The robot in a world, whole: physics, firmware and Kinect, stepped by its owner.

simulation = RobotSimulation("paper_room", seed=1)
simulation.drive(0.3, 0.0)
while not simulation.fallen:
    simulation.step(0.1)
    depth = simulation.frame()
"""

import math

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats, FloorPlane, axes, check_camera
from cliffscan.simulator.body import Body
from cliffscan.simulator.faces import faces_of
from cliffscan.simulator.kinect import Image, KinectModel, Millimetres, SensorModel, kinect_camera, sense
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.kobuki.firmware import DEAD_TIME, Firmware
from cliffscan.simulator.kobuki.kinematics import TRACK, Wheels, limited
from cliffscan.simulator.kobuki.line import Line
from cliffscan.simulator.kobuki.ticker import SECOND
from cliffscan.simulator.rasteriser import depth_image
from cliffscan.simulator.senses import Reporter, feel
from cliffscan.simulator.wheels import PhysicalWheels
from cliffscan.simulator.world import START, Pose, World

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


CAMERA_X = -0.087  # [m] the Kinect of a TurtleBot 2 stands behind the wheels


class RobotSimulation:
    """A TurtleBot 2 in a world by name, the same for the same seed and the same calls. Time passes only in `step`.

    camera, sensor: a Kinect by default, at its nominal mount; where it truly is follows from the body, which nods.
    wheels: how the motors follow a command; dead_time: [s] from a command to the motors.
    Raises ValueError for an unknown world, an impossible camera or dead time.
    """

    def __init__(
        self,
        world: str,
        pose: Pose = START,
        seed: int = 0,
        camera: Camera | None = None,
        sensor: SensorModel | None = None,
        wheels: WheelModel | None = None,
        dead_time: float = DEAD_TIME,
    ) -> None:
        self.world = World(world, pose)
        self.camera = camera or kinect_camera()
        self.sensor: SensorModel = sensor or KinectModel()
        check_camera(self.camera)
        self.base = RobotBase(Body(world, pose), wheels, dead_time, seed)
        self._faces = faces_of(self.world)
        self._rng = np.random.default_rng(seed)

    @property
    def time(self) -> float:
        """Time [s] that has passed."""
        return self.base.time

    @property
    def pose(self) -> Pose:
        """Where the middle between the wheels truly is."""
        return self.base.body.pose

    @property
    def fallen(self) -> bool:
        """Whether it has fallen since it was placed."""
        return self.base.fallen

    @property
    def bumped(self) -> bool:
        """Whether anything pushed its hull, from any side, since the last step began."""
        return self.base.bumped

    def place(self, pose: Pose) -> None:
        """Put the robot down elsewhere, at rest and unhurt."""
        self.base.place(pose)

    def drive(self, linear: float, angular: float) -> None:
        """Command the motors without a driver [m/s, rad/s]; they obey after the dead time, until told otherwise."""
        half = angular * TRACK / 2
        self.base.firmware.motors.command(limited(Wheels(linear - half, linear + half)))

    def step(self, dt: float, heard: bytes = b"") -> bytes:
        """Hear bytes from the driver, let time pass [s]; what the base says meanwhile."""
        self.base.receive(heard)
        return b"".join(self.base.step(dt))

    def depth(self) -> Image:
        """Exact depth [m] of what the camera sees now: (rows, cols), inf = nothing."""
        return depth_image(self._faces, *self.camera_pose(), self.camera)

    def frame(self) -> Millimetres:
        """What the sensor sees now: (rows, cols) [mm], 0 = no return."""
        return sense(self.depth(), self.camera, self.sensor, self._rng)

    def camera_pose(self) -> tuple[Floats, Floats]:
        """The camera's true position (3,) [m] in the world, and rotation (3, 3) to it from its optical frame."""
        body = self.base.body
        position = body.position + body.rotation @ np.array([CAMERA_X, 0.0, self.camera.floor.d])
        return position, body.rotation @ np.stack(axes(self.camera.floor))

    def viewpoint(self) -> Pose:
        """Where scans are taken from: the floor below the camera, heading along its optical axis."""
        (x, y, _), rotation = self.camera_pose()
        return Pose(float(x), float(y), math.atan2(rotation[1, 2], rotation[0, 2]))

    def floor(self) -> FloorPlane:
        """The plane z = 0 as the camera truly stands over it: what a floor tracker should find on a level floor."""
        position, rotation = self.camera_pose()
        nx, ny, nz = rotation[2].tolist()
        return FloorPlane(nx, ny, nz, float(position[2]))
