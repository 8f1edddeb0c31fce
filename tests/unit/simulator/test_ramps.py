"""The truth where floors are not level: along ramps, over platforms, and off their sides."""

import math

import mujoco
import numpy as np
import pytest

from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.footprints import footprints
from cliffscan.simulator.kinect import kinect_camera
from cliffscan.simulator.profile import CLIMB, FAR, standing
from cliffscan.simulator.truth import BODY, floor_edge, obstacle, outlines
from cliffscan.simulator.world import Pose, World

HEIGHT = 0.104890  # [m] of the office's platform
AROUND = np.radians(np.arange(-180.0, 180.0, 19.3))
STEP = 0.02  # [m] of the march along a beam
REACH = 6.0  # [m]


def solid(world, points):
    """Whether points (n, 3) [m] are within any geom: (n,)."""
    offsets = points - world.data.geom_xpos[:, None]
    local = np.abs(offsets @ world.data.geom_xmat.reshape(-1, 3, 3))
    sizes, boxes = world.model.geom_size[:, None], world.model.geom_type[:, None] == mujoco.mjtGeom.mjGEOM_BOX
    in_box = (local <= sizes).all(axis=-1)
    in_cylinder = (np.hypot(local[..., 0], local[..., 1]) <= sizes[..., 0]) & (local[..., 2] <= sizes[..., 1])
    return np.where(boxes, in_box, in_cylinder).any(axis=0)


def marched(world, angle):
    """Where a walker on a beam finds no floor within a step's height, and where a post of a robot's height hits."""
    ground, edge = standing(footprints(world), world.pose), math.inf
    direction = np.array([math.cos(world.pose.yaw + angle), math.sin(world.pose.yaw + angle)])
    rises = np.append(np.arange(CLIMB, -CLIMB, -0.001), 0.0)
    posts = np.arange(CLIMB + 0.001, BODY[1], 0.08)
    for distance in np.arange(0.0, REACH, STEP):
        place = [world.pose.x, world.pose.y] + distance * direction
        heights = ground + np.concatenate([rises - 1e-6, posts])  # below by so much, a surface is surely found
        found = solid(world, np.column_stack([np.tile(place, (len(heights), 1)), heights]))
        under, post = np.split(found, [len(rises)])
        if under.any():
            ground += rises[np.argmax(under)]
        else:
            edge = min(edge, distance)
        if post.any():
            return edge, distance
    return edge, math.inf


@pytest.mark.parametrize(
    ("name", "pose"),
    [
        ("office", Pose(2.4, -1.5, 0.25)),
        ("office", Pose(3.2, -2.0, 1.0)),
        ("office", Pose(4.5, -2.1, 0.2)),
        ("office", Pose(0.2, 0.1, 0.0)),
        ("landing", Pose(1.0, 0.0, 0.0)),
        *((f"random:{seed}", Pose()) for seed in (2, 7)),
    ],
)
def test_the_truth_is_what_a_walker_meets(name, pose):
    world = World(name, pose)
    edges, obstacles = floor_edge(world, AROUND), obstacle(world, AROUND, *BODY)
    for angle, edge, blocked in zip(AROUND, edges, obstacles, strict=True):
        walked, hit = marched(world, angle)
        assert min(blocked, REACH) == pytest.approx(min(hit, REACH), abs=STEP + 0.01), math.degrees(angle)
        walked = math.inf if hit <= walked + STEP else walked
        assert min(edge, REACH) == pytest.approx(min(walked, REACH), abs=STEP + 0.01), math.degrees(angle)


def test_a_ramp_is_floor_and_its_side_an_edge():
    on_top = World("office", Pose(4.5, -2.1, math.pi / 2))  # looking across the platform
    assert floor_edge(on_top, np.zeros(1)) == pytest.approx([0.9])
    along = World("office", Pose(2.0, -2.1))
    assert floor_edge(along, np.zeros(1))[0] == math.inf
    assert obstacle(along, np.zeros(1), *BODY) == pytest.approx([7.5 - 2.0])  # the wall, far behind both ramps
    below = World("office", Pose(4.5, 0.0, -math.pi / 2))
    assert obstacle(below, np.zeros(1), *BODY) == pytest.approx([1.2])  # the platform's side
    assert floor_edge(below, np.zeros(1))[0] == math.inf


def test_a_ramps_side_is_in_the_way_where_it_is_higher_than_a_step():
    """Looking along a ramp's side at a slant: the beam reaches it where it is 3 cm high, or 5 mm."""
    x = {height: 2.25 + 1.5 * height / HEIGHT for height in (0.03, 0.005)}
    for height, where in x.items():
        world = World("office", Pose(where, -0.2, -math.pi / 2))
        hit = obstacle(world, np.zeros(1), *BODY)[0]
        assert hit == pytest.approx(1.0 if height > CLIMB else 2.8, abs=1e-6)


def test_the_outlines_show_ramps_as_floor():
    world = World("office")
    floors = [outline.polygon for outline in outlines(world) if outline.kind == "floor"]
    assert len(floors) == 5
    assert any(np.allclose(polygon[:, 0].min(), 2.25, atol=1e-6) for polygon in floors)


def test_the_rendered_depth_of_a_ramp_is_its_height():
    """From the ramp's foot: what the camera sees on the ramp and the platform lies as high as the truth has it."""
    kinect = SimulatedKinect("office", kinect_camera())
    kinect.move(Pose(1.9, -2.1))
    depth = kinect.depth()
    camera, middle = kinect.camera, kinect.camera.width // 2
    rows = np.arange(300, camera.height)
    down = (rows - camera.intrinsics.cy) / camera.intrinsics.fy
    height, ahead = 0.30 - depth[rows, middle] * down, depth[rows, middle]
    ramp = (ahead > 0.36) & (ahead < 1.84)
    np.testing.assert_allclose(height[ramp], (ahead[ramp] - 0.35) * math.tan(math.radians(4.0)), atol=1e-5)
    assert ramp.sum() > 100


def test_a_floor_far_away_ends_before_the_last_break():
    assert floor_edge(World("open_floor"), AROUND).max() < FAR


def test_a_steep_box_is_no_ramp():
    world = World("office")
    geom = world.model.geom("ramp_up").id
    half = math.radians(10.0) / 2
    mujoco.mju_quat2Mat(world.data.geom_xmat[geom], np.array([math.cos(half), 0.0, -math.sin(half), 0.0]))
    with pytest.raises(ValueError, match=r"of world 'office' has no footprint"):
        floor_edge(world, AROUND)
