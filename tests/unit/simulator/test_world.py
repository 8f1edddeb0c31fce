"""The worlds load, and the camera stands in them where the floor plane says."""

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics, scan_axes
from cliffscan.simulator.world import Pose, World
from cliffscan.simulator.world_names import world_names

KNOWN = ["empty_room", "landing", "office", "open_floor", "paper_room", "paper_room_open", "stairs_corridor"]
OPEN_FLOOR = World("open_floor")


def test_the_worlds_are_found():
    assert set(KNOWN) <= set(world_names())


def test_an_unknown_world_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match=r"'atlantis'.*empty_room, .*paper_room, paper_room_open.* random:SEED"):
        World("atlantis")


@pytest.mark.parametrize("name", ["../worlds/paper_room", "random:", "random:-1", "random:x"])
def test_what_is_no_name_is_refused(name):
    with pytest.raises(ValueError, match="no world"):
        World(name)


@pytest.mark.parametrize("name", KNOWN)
def test_the_robot_starts_on_the_floor(name):
    world = World(name)
    down = mujoco.mj_ray(
        world.model,
        world.data,
        np.array([0.0, 0.0, 0.2]),
        np.array([0.0, 0.0, -1.0]),
        None,
        1,
        -1,
        np.zeros(1, np.int32),
    )
    assert down == pytest.approx(0.2)


def test_a_robots_geoms_are_not_of_the_scene():
    world = World("empty_room")
    everything = world.scene_geoms()
    world.model.geom_group[1] = 1
    assert world.scene_geoms() == [geom for geom in everything if geom != 1]


def test_a_level_camera_looks_along_the_robots_heading():
    world = World("open_floor", Pose(1.0, 2.0, np.pi / 2))
    camera = Camera(4, 3, Intrinsics(3.0, 3.0, 1.5, 1.0), (0.5, 4.5), FloorPlane.from_mount(0.3))
    position, rotation = world.camera_pose(camera)
    np.testing.assert_allclose(position, [1.0, 2.0, 0.3])
    np.testing.assert_allclose(rotation @ [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], atol=1e-12)  # forward is +y
    np.testing.assert_allclose(rotation @ [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], atol=1e-12)  # the image's right is +x


@given(yaw=st.floats(-3.2, 3.2), pitch=st.floats(-1.0, 1.0), roll=st.floats(-0.5, 0.5))
def test_the_camera_pose_agrees_with_the_scan_frame(yaw, pitch, roll):
    camera = Camera(8, 6, Intrinsics(7.0, 6.0, 3.5, 2.5), (0.5, 4.5), FloorPlane.from_mount(0.4, pitch, roll))
    OPEN_FLOOR.pose = Pose(yaw=yaw)
    _, rotation = OPEN_FLOOR.camera_pose(camera)
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    u, v = np.meshgrid(np.arange(8), np.arange(6))
    rays = np.stack([(u - 3.5) / 7.0, (v - 2.5) / 6.0, np.ones(u.shape)], axis=-1) @ rotation.T
    cos, sin = np.cos(yaw), np.sin(yaw)
    np.testing.assert_allclose(rays[..., 0], cos * forward - sin * left, atol=1e-12)
    np.testing.assert_allclose(rays[..., 1], sin * forward + cos * left, atol=1e-12)
    np.testing.assert_allclose(rays[..., 2], up, atol=1e-12)
