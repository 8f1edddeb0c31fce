"""The robot's body in a world: MuJoCo moves it, the rest of the simulator reads it here.

Its frame is REP-103's base_link: x ahead, y left, z up, the origin on the floor between the wheels.
"""

import math
from importlib.resources import files
from typing import NamedTuple

import mujoco
import numpy as np

from cliffscan.common.contract.camera import Floats
from cliffscan.simulator.kobuki.kinematics import TRACK, Wheels
from cliffscan.simulator.world import SCENE, START, Pose, world_source

STEP = 2_000_000  # [ns] of the physics
SIDES = ("left", "right")
STEEPEST = math.sqrt(0.5)  # of a push's direction along the body's up: what comes from farther below is the ground
PREFIX = "robot/"
FALLEN_DEPTH = 0.04  # [m] below the floor


class BodyModel(NamedTuple):
    """A body with two driven wheels, in the file NAME.xml beside this one."""

    name: str
    wheel_radius: float  # [m]
    track: float  # [m] between the wheels
    hull: tuple[str, ...]  # the geoms that may bump into something


TURTLEBOT_2 = BodyModel("turtlebot2", 0.035, TRACK, ("base", "plates"))
ONLY_SCENE = np.array([group == SCENE for group in range(6)], dtype=np.uint8)


class Body:
    """A robot, a TurtleBot 2 unless told otherwise, that stands in a world. Raises ValueError for an unknown world."""

    def __init__(self, world: str, pose: Pose = START, kind: BodyModel = TURTLEBOT_2) -> None:
        self.kind = kind
        self.model = model_of(world, kind)
        self.data = mujoco.MjData(self.model)
        self._base = self.model.body(f"{PREFIX}base").id
        self._hull = np.isin(np.arange(self.model.ngeom), [self.model.geom(f"{PREFIX}{name}").id for name in kind.hull])
        self._turned = [self.model.joint(f"{PREFIX}{side}_wheel").qposadr[0] for side in SIDES]
        self._turning = [self.model.joint(f"{PREFIX}{side}_wheel").dofadr[0] for side in SIDES]
        self._springs = [self.model.joint(f"{PREFIX}{side}_spring").qposadr[0] for side in SIDES]
        self.place(pose)

    def place(self, pose: Pose, height: float = 0.0) -> None:
        """Put the robot down at rest, upright, `height` [m] over z = 0."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:3] = pose.x, pose.y, height
        self.data.qpos[3:7] = math.cos(pose.yaw / 2), 0.0, 0.0, math.sin(pose.yaw / 2)
        mujoco.mj_forward(self.model, self.data)

    def has_fallen(self, tilt: float) -> bool:
        """Whether it tilts by more [rad], or sank."""
        return self.tilt > tilt or float(self.position[2]) < -FALLEN_DEPTH

    def step(self, speeds: Wheels) -> None:
        """Let one STEP pass, in which the motors make for these speeds of the rims [m/s]."""
        self.data.ctrl[:] = speeds.left / self.kind.wheel_radius, speeds.right / self.kind.wheel_radius
        mujoco.mj_step(self.model, self.data)

    @property
    def position(self) -> Floats:
        """The origin in the world: (3,) [m]."""
        position: Floats = self.data.xpos[self._base]
        return position

    @property
    def rotation(self) -> Floats:
        """From the body's frame to the world's: (3, 3)."""
        rotation: Floats = self.data.xmat[self._base].reshape(3, 3)
        return rotation

    @property
    def pose(self) -> Pose:
        """Where it stands, and where it heads seen from above."""
        x, y, _ = self.position.tolist()
        return Pose(x, y, math.atan2(self.rotation[1, 0], self.rotation[0, 0]))

    @property
    def rates(self) -> tuple[float, float, float]:
        """How fast it turns about its own x, y and z [rad/s]."""
        roll, pitch, yaw = self.data.qvel[3:6].tolist()
        return roll, pitch, yaw

    @property
    def tilt(self) -> float:
        """Angle [rad] between its own up and the world's."""
        return math.acos(max(-1.0, min(1.0, float(self.rotation[2, 2]))))

    @property
    def rims(self) -> Wheels:
        """How far each rim has turned [m]."""
        left, right = (self.kind.wheel_radius * float(self.data.qpos[place]) for place in self._turned)
        return Wheels(left, right)

    @property
    def rim_speeds(self) -> Wheels:
        """Speed of each rim [m/s]."""
        left, right = (self.kind.wheel_radius * float(self.data.qvel[place]) for place in self._turning)
        return Wheels(left, right)

    @property
    def droop(self) -> Wheels:
        """How far each wheel hangs below its place on a level floor [m]."""
        left, right = (-float(self.data.qpos[place]) for place in self._springs)
        return Wheels(left, right)

    def contacts(self) -> Floats:
        """Where the hull is pushed from the side: directions [rad] in its own frame, counter-clockwise from ahead."""
        touching = self.data.contact
        hull = self._hull[touching.geom].any(axis=1)
        if not hull.any():
            return np.empty(0)
        sideways = np.abs(touching.frame[:, :3] @ self.rotation[:, 2]) < STEEPEST
        points = (touching.pos[hull & sideways] - self.position) @ self.rotation
        angles: Floats = np.arctan2(points[:, 1], points[:, 0])
        return angles

    def below(self, point: tuple[float, float, float]) -> float:
        """Distance [m] along the body's own down from a point of it [m] to the scene; inf where there is nothing."""
        start = self.position + self.rotation @ np.array(point)
        geom = np.zeros(1, dtype=np.int32)
        distance = mujoco.mj_ray(self.model, self.data, start, -self.rotation[:, 2].copy(), ONLY_SCENE, 1, -1, geom)
        return distance if distance >= 0.0 else math.inf


def model_of(world: str, kind: BodyModel) -> mujoco.MjModel:
    """The physics of a world with the robot in it."""
    scene = mujoco.MjSpec.from_string(world_source(world))
    scene.option.timestep = STEP * 1e-9
    scene.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    scene.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    scene.option.impratio = 10.0  # wheels grip rather than creep
    robot = mujoco.MjSpec.from_string((files("cliffscan.simulator") / f"{kind.name}.xml").read_text(encoding="utf-8"))
    scene.attach(robot, frame=scene.worldbody.add_frame(), prefix=PREFIX)
    return scene.compile()
