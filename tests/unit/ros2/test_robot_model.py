"""The URDF says of the robot what its description and the fixed frames say."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest

from cliffscan.common.contract.description import BodyDescription, CameraDescription, Place
from cliffscan.services.ros2.robot_model import roll_pitch_yaw, urdf
from cliffscan.services.ros2.transforms import of_camera, quaternion
from tests.build import camera

BODY = BodyDescription(simulated=False, radius=0.18, height=0.42)
FRAMES = of_camera(CameraDescription.of(camera(), "eye", False, Place(-0.087, 0.0, 0.0)), "base_link", 0.12, stamp=5)


def parsed(body):
    return ElementTree.fromstring(urdf("turtlebot", "base_link", body, FRAMES))  # noqa: S314 - we wrote it


def numbers(element, name):
    return [float(each) for each in element.get(name).split()]


def test_a_body_is_a_cylinder_that_stands_on_the_floor():
    base = parsed(BODY).find("link[@name='base_link']")
    for part in ("visual", "collision"):
        cylinder = base.find(f"{part}/geometry/cylinder")
        assert (float(cylinder.get("radius")), float(cylinder.get("length"))) == (0.18, 0.42)
        assert numbers(base.find(f"{part}/origin"), "xyz") == [0.0, 0.0, 0.21]


def test_every_fixed_frame_is_a_link_that_a_joint_places():
    root = parsed(None)
    assert root.get("name") == "turtlebot"
    assert root.find("link[@name='base_link']/visual") is None
    links = [each.get("name") for each in root.iter("link") if each.get("name")]
    assert links == ["base_link", "camera_footprint", "camera_scan", "camera_link", "eye"]
    joints = root.findall("joint")
    assert [each.find("child").get("link") for each in joints] == links[1:]
    assert [each.find("parent").get("link") for each in joints] == [each.parent for each in FRAMES]
    assert {each.get("type") for each in joints} == {"fixed"}
    assert numbers(joints[0].find("origin"), "xyz") == [-0.087, 0.0, 0.0]
    assert numbers(joints[3].find("origin"), "rpy") == pytest.approx([-math.pi / 2, 0.0, -math.pi / 2], abs=1e-5)


@pytest.mark.parametrize("angles", [(0.1, 0.2, 0.3), (-2.0, 0.5, 3.0), (0.0, -1.2, -0.4)])
def test_roll_pitch_and_yaw_are_turns_about_fixed_axes(angles):
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    assert roll_pitch_yaw(quaternion(about_z @ about_y @ about_x)) == pytest.approx(angles)
