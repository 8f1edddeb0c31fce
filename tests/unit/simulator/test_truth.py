"""The truth about edges and obstacles is that of the worlds' measures, and of MuJoCo's own rays."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.footprints import Footprint
from cliffscan.simulator.truth import BODY, floor_edge, obstacle, outlines
from cliffscan.simulator.world import Pose, World
from cliffscan.simulator.world_names import world_names

FORWARD = np.radians(np.linspace(-29.0, 29.0, 117))
AROUND = np.radians(np.arange(-180.0, 180.0, 7.3))
STEP = 0.01  # [m] of the march along a beam


def ray(world, point, direction):
    """Distance [m] to what a ray hits first; inf where it hits nothing."""
    found = mujoco.mj_ray(
        world.model, world.data, np.array(point), np.array(direction), None, 1, -1, np.zeros(1, np.int32)
    )
    return found if found >= 0.0 else math.inf


def marched_edge(world, angle, stop):
    """Distance [m] at which a plumb line carried along a beam first finds no floor; inf before it has gone to stop."""
    cos, sin = math.cos(world.pose.yaw + angle), math.sin(world.pose.yaw + angle)
    for distance in np.arange(0.0, min(stop, 6.0), STEP):
        point = [world.pose.x + distance * cos, world.pose.y + distance * sin, 0.005]
        if ray(world, point, [0.0, 0.0, -1.0]) > 0.006:
            return distance
    return math.inf


@pytest.mark.parametrize("name", ["paper_room", "paper_room_open"])
def test_the_holes_near_edge(name):
    edge = floor_edge(World(name), FORWARD)
    np.testing.assert_allclose(edge, 1.5 / np.cos(FORWARD), rtol=1e-12)  # all of 58° looks into the hole


def test_the_edge_follows_the_robot():
    world = World("paper_room", Pose(0.5, 0.2, 0.1))
    np.testing.assert_allclose(floor_edge(world, np.array([-0.1, 0.0])), [1.0, 1.0 / math.cos(0.1)], rtol=1e-12)


def test_the_holes_side_edge():
    """From beside the hole, looking across it."""
    world = World("paper_room", Pose(2.5, -1.8, math.pi / 2))
    np.testing.assert_allclose(floor_edge(world, np.array([-0.3, 0.0, 0.3])), 0.8 / np.cos([-0.3, 0.0, 0.3]))


def test_the_first_stair():
    edge = floor_edge(World("stairs_corridor"), np.array([0.0, 0.2]))
    np.testing.assert_allclose(edge, 2.0 / np.cos([0.0, 0.2]), rtol=1e-12)


@pytest.mark.parametrize("name", ["empty_room", "open_floor"])
def test_a_floor_that_ends_nowhere_within_reach(name):
    edge = floor_edge(World(name), AROUND)
    assert (np.isinf(edge) | (edge > 29.0)).all()
    assert np.isinf(edge).all() == (name == "empty_room")


def test_a_robot_over_a_hole_has_no_floor():
    assert floor_edge(World("paper_room", Pose(2.5, 0.0)), AROUND).tolist() == [0.0] * len(AROUND)


def test_a_wall_ends_the_beam_before_the_floor_does():
    world = World("paper_room")
    sideways = np.array([math.pi / 2, -math.pi / 2, math.pi])
    assert np.isinf(floor_edge(world, sideways)).all()
    np.testing.assert_allclose(obstacle(world, sideways, *BODY), [2.4, 2.4, 1.4])
    assert np.isfinite(floor_edge(world, sideways, heights=(1.3, 1.4))).all()  # above the walls nothing ends it


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", [name for name in world_names() if name != "office"])  # it has ramps: see test_ramps
def test_the_truth_is_what_rays_find(name, seed):
    rng = np.random.default_rng(seed)
    world = World(name, Pose(rng.uniform(-1.0, 1.4), rng.uniform(-0.5, 0.6), rng.uniform(-np.pi, np.pi)))
    edges, obstacles = floor_edge(world, AROUND), obstacle(world, AROUND, *BODY)
    for angle, edge, blocked in zip(AROUND, edges, obstacles, strict=True):
        heading = [math.cos(world.pose.yaw + angle), math.sin(world.pose.yaw + angle), 0.0]
        assert blocked == pytest.approx(ray(world, [world.pose.x, world.pose.y, 0.2], heading), abs=1e-9)
        assert min(edge, 6.0) == pytest.approx(min(marched_edge(world, angle, blocked), 6.0), abs=STEP)


def test_heights_decide_what_is_an_obstacle():
    world = World("stairs_corridor", Pose(0.7, 0.0))
    right = np.array([-math.pi / 2])
    handrail, wall = 0.66 - 0.03, 2.8
    assert obstacle(world, right, 0.91, 0.93)[0] == pytest.approx(handrail)
    assert obstacle(world, right, 0.01, 0.42)[0] == pytest.approx(wall)  # between two posts, under the handrail
    assert obstacle(world, np.array([0.0]), 0.0, 0.42)[0] == math.inf  # the floor is no obstacle
    assert obstacle(world, np.array([0.0]), -0.2, 0.42)[0] == 0.0  # to something in it, it is


@given(
    x=st.floats(-3, 3), y=st.floats(-3, 3), angle=st.floats(-3.2, 3.2), yaw=st.floats(-3.2, 3.2), at=st.floats(-8, 8)
)
@pytest.mark.parametrize("size", [[0.7], [0.4, 1.1]])
def test_a_crossing_is_where_the_line_is_inside(size, x, y, angle, yaw, at):
    shape = Footprint(np.array([0.2, -0.3]), np.array(size), yaw, 0.0, 1.0)
    (enter,), (leave,) = shape.crossing(np.array([x, y]), np.array([angle]))
    dx, dy = x + at * math.cos(angle) - 0.2, y + at * math.sin(angle) + 0.3
    along, across = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
    depth = size[0] - math.hypot(dx, dy) if len(size) == 1 else min(size[0] - abs(along), size[1] - abs(across))
    if depth > 1e-6:
        assert enter <= at <= leave
    if depth < -1e-6:
        assert not enter <= at <= leave


def test_a_line_along_a_boxs_axis():
    box = Footprint(np.zeros(2), np.array([1.0, 2.0]), 0.0, 0.0, 1.0)
    enter, leave = box.crossing(np.array([-3.0, 0.5]), np.array([0.0]))
    assert (enter[0], leave[0]) == pytest.approx((2.0, 4.0))
    enter, leave = box.crossing(np.array([-3.0, 2.5]), np.array([0.0]))
    assert (enter[0], leave[0]) == (math.inf, -math.inf)


def area(polygon):
    x, y = polygon.T
    return float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) / 2)


def test_the_outlines_are_the_floor_plan():
    drawn = outlines(World("paper_room"))
    floor = [outline.polygon for outline in drawn if outline.kind == "floor"]
    assert sum(map(area, floor)) == pytest.approx(5.8 * 5.0 - 2.0 * 2.0)  # the room without the hole
    assert all((outline.polygon[0] == outline.polygon[-1]).all() for outline in drawn)
    assert [outline.kind for outline in drawn] == ["lower"] + ["floor"] * 4 + ["obstacle"] * 4


def test_the_outlines_tell_stairs_posts_and_handrail_apart():
    drawn = outlines(World("stairs_corridor"))
    kinds = [outline.kind for outline in drawn]
    assert {kind: kinds.count(kind) for kind in set(kinds)} == {"lower": 10, "floor": 1, "obstacle": 9, "overhead": 1}
    post = next(outline.polygon for outline in drawn if outline.kind == "obstacle" and len(outline.polygon) > 5)
    assert area(post) == pytest.approx(math.pi * 0.02**2)


@pytest.mark.parametrize("change", ["sphere", "tilted"])
def test_a_geom_without_a_footprint_is_refused(change):
    world = World("empty_room")
    if change == "sphere":
        world.model.geom_type[1] = mujoco.mjtGeom.mjGEOM_SPHERE
    else:
        world.data.geom_xmat[1] = [1.0, 0.0, 0.0, 0.0, 0.8, -0.6, 0.0, 0.6, 0.8]
    with pytest.raises(ValueError, match="geom 1 of world 'empty_room'"):
        floor_edge(world, AROUND)
