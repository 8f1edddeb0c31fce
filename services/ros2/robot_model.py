"""What the robot looks like in ROS, from its description: the fixed frames, and a small URDF made of them."""

import math
import threading
from collections.abc import Sequence
from xml.etree import ElementTree

from cliffscan.common.contract import topics
from cliffscan.common.contract.description import BodyDescription, CameraDescription, RobotDescription
from cliffscan.safety.visible_floor import UNDESCRIBED_NEAREST
from cliffscan.services.ros2 import interfaces, messages, transforms
from cliffscan.services.ros2.cdr import CdrError
from cliffscan.services.ros2.config import Ros2Config
from cliffscan.services.ros2.node import Profile
from cliffscan.services.ros2.ports import Node, Service
from cliffscan.services.ros2.transforms import Quaternion, Transform

FLAT = 0.01  # [m] height at which a body is drawn whose height is not known


class RobotModel:
    """Keeps /tf_static and /robot_description as the robot's last description has them; safe to use from any thread."""

    def __init__(self, service: Service[Ros2Config], node: Node) -> None:
        self._service = service
        self._static = node.publisher("tf_static", interfaces.TF_MESSAGE, Profile.LATCHED)
        self._urdf = node.publisher("robot_description", interfaces.STRING, Profile.LATCHED)
        self._lock = threading.Lock()
        self._camera: CameraDescription | None = None
        self._body: BodyDescription | None = None
        service.receive_latched(topics.DESCRIPTION, self._described)

    @property
    def nearest_floor(self) -> float:
        """From where on [m] the camera sees floor."""
        return self._camera.nearest_floor if self._camera else UNDESCRIBED_NEAREST

    def _described(self, description: RobotDescription) -> None:
        config = self._service.config
        with self._lock:
            self._camera, self._body = description.camera or self._camera, description.body or self._body
            frames: list[Transform] = []
            if self._camera:
                frames = transforms.of_camera(self._camera, config.base_frame, config.scan_height, description.stamp)
            placed = [each for each in frames if each.child not in self._frames_of_others()]
            try:
                if placed:
                    self._static.put(messages.tf_message(placed))
            except CdrError as error:
                self._service.metrics.warn_limited("malformed", f"{topics.DESCRIPTION.path}: {error}")
            self._urdf.put(messages.string(urdf(self._service.bus.robot, config.base_frame, self._body, placed)))

    def _frames_of_others(self) -> set[str]:
        """The camera's frames, where a driver in ROS places them."""
        if self._camera is None or self._service.config.camera != "external":
            return set()
        return {self._camera.frame, transforms.CAMERA}


def urdf(robot: str, base_frame: str, body: BodyDescription | None, frames: Sequence[Transform]) -> str:
    """The URDF of a robot: a cylinder on the floor around the base frame, and a link for each fixed frame."""
    root = ElementTree.Element("robot", name=robot)
    base = ElementTree.SubElement(root, "link", name=base_frame)
    if body is not None:
        height = body.height or FLAT
        for part in ("visual", "collision"):
            element = ElementTree.SubElement(base, part)
            ElementTree.SubElement(element, "origin", xyz=_numbers(0.0, 0.0, height / 2))
            geometry = ElementTree.SubElement(element, "geometry")
            ElementTree.SubElement(geometry, "cylinder", radius=f"{body.radius:g}", length=f"{height:g}")
    for frame in frames:
        ElementTree.SubElement(root, "link", name=frame.child)
        joint = ElementTree.SubElement(root, "joint", name=f"{frame.child}_joint", type="fixed")
        ElementTree.SubElement(joint, "parent", link=frame.parent)
        ElementTree.SubElement(joint, "child", link=frame.child)
        place = {"xyz": _numbers(*frame.translation), "rpy": _numbers(*roll_pitch_yaw(frame.rotation))}
        ElementTree.SubElement(joint, "origin", place)
    return ElementTree.tostring(root, encoding="unicode")


def roll_pitch_yaw(rotation: Quaternion) -> tuple[float, float, float]:
    """A rotation as URDF has it [rad]: about the fixed x, then y, then z."""
    x, y, z, w = rotation
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
    return roll, pitch, transforms.heading_of(rotation)


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.6g}" for value in values)
