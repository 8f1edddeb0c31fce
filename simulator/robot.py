"""The robot in a world, whole: physics, firmware and Kinect, stepped by its owner.

simulation = RobotSimulation("paper_room", seed=1)
simulation.drive(0.3, 0.0)
while not simulation.fallen:
    simulation.step(0.1)
    depth = simulation.frame()
"""

import math

from cliffscan.common.contract.camera import Camera, Floats, FloorPlane
from cliffscan.common.contract.description import TURTLEBOT_2
from cliffscan.simulator.body import Body
from cliffscan.simulator.kinect import Image, KinectModel, Millimetres, SensorModel, kinect_camera
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.drive import WheelModel
from cliffscan.simulator.kobuki.firmware import DEAD_TIME, Firmware
from cliffscan.simulator.kobuki.kinematics import TRACK, Wheels, limited
from cliffscan.simulator.kobuki.line import Line
from cliffscan.simulator.kobuki.ticker import SECOND
from cliffscan.simulator.mounted_camera import MountedCamera
from cliffscan.simulator.senses import Reporter, feel
from cliffscan.simulator.wheels import PhysicalWheels
from cliffscan.simulator.world import START, Pose, World

FEEL_PERIOD = 0.01  # [s] the longest time between two looks at the sensors
FALLEN_TILT = math.radians(20.0)  # more than any ramp and nod


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
        self.fallen |= self.body.has_fallen(FALLEN_TILT)


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
        self.base = RobotBase(Body(world, pose), wheels, dead_time, seed)
        model = sensor or KinectModel()
        self._mounted = MountedCamera(self.world, self.base.body, self.camera, model, TURTLEBOT_2.x, seed)

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
        return self._mounted.depth()

    def frame(self) -> Millimetres:
        """What the sensor sees now: (rows, cols) [mm], 0 = no return."""
        return self._mounted.frame()

    def camera_pose(self) -> tuple[Floats, Floats]:
        """See MountedCamera."""
        return self._mounted.camera_pose()

    def viewpoint(self) -> Pose:
        """See MountedCamera."""
        return self._mounted.viewpoint()

    def floor(self) -> FloorPlane:
        """See MountedCamera."""
        return self._mounted.floor()
