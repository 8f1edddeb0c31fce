"""Where a ROS camera stands, of its static transforms."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.services.capture.ros.mount import Joint, StaticTransforms

NONE = (0.0, 0.0, 0.0, 1.0)
OPTICAL = (-0.5, 0.5, -0.5, 0.5)  # x ahead, z up becomes z ahead, y down (REP-103)


def pitched(angle):
    return (0.0, math.sin(angle / 2), 0.0, math.cos(angle / 2))


def turned(angle):
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


def mount(*joints, frame="optical"):
    transforms = StaticTransforms()
    transforms.add(Joint(*joint) for joint in joints)
    return transforms.mount(frame)


EYE = ("camera", "optical", (0.0, 0.0, 0.0), OPTICAL)


def test_a_level_camera():
    found = mount(("base_link", "camera", (0.1, -0.02, 0.3), NONE), EYE)
    assert found.floor == pytest.approx((0.0, -1.0, 0.0, 0.3))
    assert found.place == pytest.approx((0.1, -0.02, 0.0))


@pytest.mark.parametrize("pitch", [0.2, -0.3, 1.0])
@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_a_camera_that_looks_down_and_aside(pitch, yaw):
    joints = ("base_link", "mast", (0.2, 0.1, 0.5), turned(yaw)), ("mast", "camera", (0.0, 0.0, 0.1), pitched(pitch))
    found = mount(*joints, EYE)
    assert found.floor == pytest.approx(FloorPlane.from_mount(0.6, pitch))
    assert found.place == pytest.approx((0.2, 0.1, yaw))


def test_a_camera_that_leans_to_its_right():
    roll = 0.3
    leaning = (math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2))
    found = mount(("base_link", "camera", (0.0, 0.0, 0.4), leaning), EYE)
    assert found.floor == pytest.approx(FloorPlane.from_mount(0.4, 0.0, roll))


@pytest.mark.parametrize(
    "joints",
    [
        [("base_footprint", "base_link", (0.0, 0.0, 0.1), NONE)],
        [("base_link", "base_footprint", (0.0, 0.0, -0.1), NONE)],
        [
            ("robot", "base_link", (5.0, 1.0, 0.3), turned(1.0)),
            ("robot", "base_footprint", (5.0, 1.0, 0.2), turned(1.0)),
        ],
    ],
    ids=["above", "below", "beside"],
)
def test_the_footprint_counts_before_the_link(joints):
    found = mount(*joints, ("base_link", "camera", (0.1, 0.0, 0.3), NONE), EYE)
    assert found.floor == pytest.approx((0.0, -1.0, 0.0, 0.4))
    assert found.place == pytest.approx((0.1, 0.0, 0.0))


def test_names_may_begin_with_a_slash_and_rotations_may_be_rounded():
    joint = ("/base_link", "/optical", (0.0, 0.0, 0.3), tuple(np.multiply(OPTICAL, 1.01)))
    assert mount(joint, frame="/optical").floor == pytest.approx((0.0, -1.0, 0.0, 0.3))


def test_the_last_word_on_a_joint_counts():
    joints = [("base_link", "optical", (0.0, 0.0, height), OPTICAL) for height in (0.3, 0.5)]
    assert mount(*joints).floor.d == pytest.approx(0.5)


@pytest.mark.parametrize("joints", [[], [EYE], [("base_link", "camera", (0.0, 0.0, 0.3), NONE)]])
def test_a_camera_that_nothing_joins_to_a_base_has_no_mount(joints):
    assert mount(*joints) is None


@pytest.mark.parametrize(
    ("joint", "why"),
    [
        (("base_link", "optical", (0.0, 0.0, 0.3), (0.0, 0.0, 0.0, 0.0)), "from base_link to optical is none"),
        (("base_link", "optical", (0.0, 0.0, math.nan), NONE), "is none"),
        (("base_link", "optical", (0.0, 0.0, 0.3), (math.nan, 0.0, 0.0, 1.0)), "is none"),
        (("base_link", "optical", (1e9, 0.0, 0.3), OPTICAL), r"place: x of 1e\+09 m is impossible"),
        (("base_link", "optical", (0.0, -5.1, 0.3), OPTICAL), r"place: y of -5\.1 m is impossible"),
        (("optical", "optical", (0.0, 0.0, 0.3), NONE), "circle"),
    ],
)
def test_a_transform_that_is_none_is_refused(joint, why):
    with pytest.raises(ValueError, match=why):
        mount(joint)
