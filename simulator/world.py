"""A simulated world: its MuJoCo model and the robot's place in it."""

import math
import re
from importlib.resources import files
from typing import NamedTuple

import mujoco
import numpy as np

from cliffscan.common.contract.camera import Camera, Floats, axes
from cliffscan.common.runtime.suggest import suggest
from cliffscan.simulator.random_floor import PASSAGE, random_floor
from cliffscan.simulator.world_names import RANDOM, world_names

SCENE = 0  # the geom group of what stands in the room; a robot's geoms belong to another, unseen by its own camera


class Pose(NamedTuple):
    """Where the robot stands: x, y [m] on the floor (z = 0 in the world) and yaw [rad], counter-clockwise from +x."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


START = Pose()
RANDOM_FLOOR = re.compile(rf"{RANDOM}(\d+)(?::(\d\.\d+))?")  # a seed, and the room [m] around each thing


def world_source(name: str) -> str:
    """A world's MuJoCo XML. Raises ValueError for an unknown name; the message lists the known ones."""
    if numbers := RANDOM_FLOOR.fullmatch(name):
        seed, passage = numbers.groups()
        return random_floor(int(seed), float(passage or PASSAGE))
    known = world_names()
    if name not in known:
        raise ValueError(
            f"no world is named {name!r}; there are {', '.join(known)} and {RANDOM}SEED[:PASSAGE]{suggest(name, known)}"
        )
    return (files("cliffscan.simulator") / "worlds" / f"{name}.xml").read_text(encoding="utf-8")


class World:
    """A world by name, with its geoms in place and a robot standing in it. Raises ValueError for an unknown name."""

    def __init__(self, name: str, pose: Pose = START) -> None:
        self.name = name
        self.pose = pose
        self.model = mujoco.MjModel.from_xml_string(world_source(name))
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)

    def scene_geoms(self) -> list[int]:
        """Indices of the geoms that belong to the scene, not to a robot."""
        return [int(geom) for geom in np.flatnonzero(self.model.geom_group == SCENE)]

    def camera_pose(self, camera: Camera) -> tuple[Floats, Floats]:
        """Position (3,) [m] of the robot's camera in the world and rotation (3, 3) to the world from its optical frame.

        The camera stands over the robot's pose, at the height, pitch and roll its floor plane gives it; its optical
        axis points along the robot's yaw.
        """
        x, y, yaw = self.pose
        cos, sin = math.cos(yaw), math.sin(yaw)
        heading = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        return np.array([x, y, camera.floor.d]), heading @ np.stack(axes(camera.floor))
