"""Where a camera stands on the robot, of the static transforms that ROS has of it (REP-105)."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.camera import Floats, FloorPlane
from cliffscan.common.contract.description import Place, check_place

BASES = ("base_footprint", "base_link")  # frames on the floor between the wheels, the surer first
LONGEST = 32  # joints from a frame to its root; more are a circle


class Joint(NamedTuple):
    """Where a child frame stands in its parent's: translation (3,) [m], rotation as x, y, z, w."""

    parent: str
    child: str
    translation: tuple[float, ...]
    rotation: tuple[float, ...]

    def matrix(self) -> Floats:
        """(4, 4), from the child's coordinates to the parent's. Raises ValueError for no rotation."""
        x, y, z, w = self.rotation
        length = math.sqrt(x * x + y * y + z * z + w * w)
        if not 0.9 < length < 1.1 or not all(map(math.isfinite, self.translation)):
            raise ValueError(f"the transform from {self.parent} to {self.child} is none")
        x, y, z, w = x / length, y / length, z / length, w / length
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), self.translation[0]],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), self.translation[1]],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), self.translation[2]],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )


class Mount(NamedTuple):
    """The floor in the camera's optical frame, and where the camera stands on the base."""

    floor: FloorPlane
    place: Place


class StaticTransforms:
    """The joints that were published so far; a later one of the same child counts."""

    def __init__(self) -> None:
        self._joints: dict[str, Joint] = {}

    def add(self, joints: Iterable[Joint]) -> None:
        """Take in further joints; tf2 takes names with and without a slash before them."""
        for joint in joints:
            parent, child = joint.parent.lstrip("/"), joint.child.lstrip("/")
            self._joints[child] = joint._replace(parent=parent, child=child)

    def mount(self, optical: str) -> Mount | None:
        """The mount of a camera by its optical frame; None where no joints tell it. Raises ValueError."""
        root, camera = self._from_root(optical.lstrip("/"))
        for base in BASES:
            other, place = self._from_root(base)
            if other == root:  # also where the base is itself the root
                return _mount(np.linalg.inv(place) @ camera)
        return None

    def _from_root(self, frame: str) -> tuple[str, Floats]:
        """The root above a frame, and (4, 4) from the frame's coordinates to the root's. Raises ValueError."""
        matrix = np.eye(4)
        for _ in range(LONGEST):
            joint = self._joints.get(frame)
            if joint is None:
                return frame, matrix
            frame, matrix = joint.parent, joint.matrix() @ matrix
        raise ValueError(f"the static transforms go round in a circle at {frame}")


def _mount(camera: Floats) -> Mount:
    """The mount of a camera by (4, 4), from its optical coordinates to the base's. Raises ValueError."""
    up, ahead = camera[2, :3], camera[:3, 2]
    floor = FloorPlane(float(up[0]), float(up[1]), float(up[2]), float(camera[2, 3]))
    place = Place(float(camera[0, 3]), float(camera[1, 3]), math.atan2(ahead[1], ahead[0]))
    check_place(place)
    return Mount(floor, place)
