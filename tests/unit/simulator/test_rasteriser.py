"""The rasteriser's depth is that of MuJoCo's rays, in every world and from all sides."""

import mujoco
import numpy as np
import pytest

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.simulator.faces import box_faces, faces_of, pack
from cliffscan.simulator.rasteriser import depth_image
from cliffscan.simulator.world import SCENE, Pose, World
from cliffscan.simulator.world_names import world_names

ODD_ONES = 0.002  # share of the pixels that may lie on different sides of a silhouette
TOLERANCE = 1e-3  # [m]
TOLERANCE_ROUND = 2e-3  # [m] on cylinders, which are drawn as prisms
FOCUS = Intrinsics(144.3, 144.9, 79.5, 59.5)
IDENTITY = np.eye(3)


def camera(height=0.3, pitch=0.0, roll=0.0):
    return Camera(160, 120, FOCUS, (0.5, 4.5), FloorPlane.from_mount(height, pitch, roll))


def traced(world, view):
    """Depth [m] and geom of each pixel by MuJoCo's own rays; a ray of forward component 1 is as long as it is deep."""
    position, rotation = world.camera_pose(view)
    fx, fy, cx, cy = view.intrinsics
    u, v = np.meshgrid(np.arange(view.width), np.arange(view.height))
    rays = np.stack([(u - cx) / fx, (v - cy) / fy, np.ones(u.shape)], axis=-1).reshape(-1, 3) @ rotation.T
    distance, geom = np.empty(u.size), np.empty(u.size, np.int32)
    group = np.zeros(6, np.uint8)
    group[SCENE] = 1
    mujoco.mj_multiRay(
        world.model, world.data, position, rays.ravel(), group, True, -1, geom, distance, None, u.size, 1e6
    )
    distance[geom < 0] = np.inf
    return distance.reshape(u.shape), geom.reshape(u.shape)


def odd_pixels(world, view):
    """Share of the pixels whose depth differs from the traced one, or that only one of them sees."""
    depth = depth_image(faces_of(world), *world.camera_pose(view), view)
    expected, geom = traced(world, view)
    is_round = (geom >= 0) & (world.model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CYLINDER)
    both = np.isfinite(depth) & np.isfinite(expected)
    apart = np.abs(np.where(both, depth, 0.0) - np.where(both, expected, 0.0))
    wrong = apart > np.where(is_round, TOLERANCE_ROUND, TOLERANCE)
    return float(np.mean(wrong | (np.isfinite(depth) != np.isfinite(expected))))


MOUNTS = [(0.3, 0.0, 0.0), (0.3, 0.0, 0.2), (0.3, 0.4, 0.0), (0.5, -0.2, -0.3), (1.2, 0.9, 0.1)]


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("name", world_names())
def test_agrees_with_rays_from_the_start(name, mount):
    assert odd_pixels(World(name), camera(*mount)) <= ODD_ONES


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", world_names())
def test_agrees_with_rays_from_anywhere(name, seed):
    rng = np.random.default_rng(seed)
    pose = Pose(rng.uniform(-1.0, 0.9), rng.uniform(-0.4, 0.4), rng.uniform(-np.pi, np.pi))
    view = camera(rng.uniform(0.2, 1.0), rng.uniform(-0.4, 0.6), rng.uniform(-0.4, 0.4))
    assert odd_pixels(World(name, pose), view) <= ODD_ONES


def test_beside_a_post():
    world = World("stairs_corridor", Pose(1.0, -0.5, -0.9))
    view = camera()
    _, geom = traced(world, view)
    assert np.mean(world.model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CYLINDER) > 0.02
    assert odd_pixels(world, view) <= ODD_ONES


def test_neighbouring_faces_leave_no_seam():
    """Two floor boxes meet exactly on a row of pixel centres, and two more on a column."""
    halves = np.array([0.75, 1.0, 0.1])
    places = [np.array([x, y, -0.1]) for x in (0.75, 2.25) for y in (-1.0, 1.0)]
    sides = [side + place for place in places for side in box_faces(halves)]
    view = Camera(640, 480, Intrinsics(580.0, 580.0, 320.0, 240.0), (0.5, 4.5), FloorPlane.from_mount(0.3))
    position, rotation = World("open_floor").camera_pose(view)
    depth = depth_image(pack(sides), position, rotation, view)
    assert 240 + 580 * 0.3 / 1.5 == 356
    middle = depth[300:, 200:440]
    expected = 0.3 * 580.0 / (np.arange(300, 480) - 240.0)
    np.testing.assert_allclose(middle, np.broadcast_to(expected[:, None], middle.shape), rtol=1e-5)


def test_a_face_that_reaches_behind_the_camera_is_cut():
    corners = [[1.0, -999.0, -9.0], [1.0, -999.0, 999.0], [1.0, 999.0, 999.0], [1.0, 999.0, -9.0]]
    wall = pack([np.array(corners)])  # to the right, 1 m away
    view = camera()
    depth = depth_image(wall, np.zeros(3), IDENTITY, view)
    u = np.arange(160)
    with np.errstate(divide="ignore"):
        expected = np.where(u > FOCUS.cx, FOCUS.fx / (u - FOCUS.cx), np.inf)
    np.testing.assert_allclose(depth, np.broadcast_to(expected, depth.shape), rtol=1e-5)


def test_the_back_of_a_face_is_not_drawn():
    square = np.array([[-1.0, -1.0, 2.0], [-1.0, 1.0, 2.0], [1.0, 1.0, 2.0], [1.0, -1.0, 2.0]])  # faces the camera
    assert depth_image(pack([square]), np.zeros(3), IDENTITY, camera())[60, 80] == pytest.approx(2.0)
    assert np.isinf(depth_image(pack([square[::-1]]), np.zeros(3), IDENTITY, camera())).all()


def test_nothing_to_draw_is_infinitely_deep():
    depth = depth_image(pack([]), np.zeros(3), IDENTITY, camera())
    assert depth.shape == (120, 160)
    assert np.isinf(depth).all()
