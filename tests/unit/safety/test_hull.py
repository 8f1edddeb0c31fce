"""The closed form of a polygon on an arc, against the polygon moved in small steps; and hulls that cannot be."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.safety.hull import Disc, Polygon, footprint_error
from tests.naive_hull import STEP, apart, pose_on_arc

KEPT = 0.06
RECTANGLE = ((0.30, 0.25), (0.30, -0.25), (-0.40, -0.25), (-0.40, 0.25))
ELL = ((0.35, 0.20), (0.35, -0.05), (0.05, -0.05), (0.05, -0.30), (-0.30, -0.30), (-0.30, 0.20))  # not convex
TRIANGLE = ((-0.2, -0.2), (-0.2, 0.2), (0.5, 0.0))
WAY = 0.02  # [m] of the slow twin's steps

hulls = st.sampled_from([RECTANGLE, ELL, TRIANGLE])
places = st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2))
curvatures = st.one_of(st.just(0.0), st.floats(-8.0, 8.0))
sides = st.sampled_from([1, -1])


def alone(point):
    return np.array([point]).T


def nearest_on(corners, poses, point):
    """How near the slow twin's hull comes to a point at each of these poses."""
    return [apart(corners, pose, point) for pose in poses]


@given(hulls, places, sides, curvatures)
def test_it_is_the_polygon_moved_along_the_arc(corners, point, side, curvature):
    hull = Polygon(corners)
    if hull.measure(alone(point))[0] <= KEPT + STEP:
        return
    found = hull.on_arc(alone(point), side, curvature, KEPT, KEPT).distance
    longest = min(1.0, 1.9 * math.pi / abs(curvature)) if curvature else 1.0
    before = np.arange(0.0, min(found, longest), WAY)
    assert min(nearest_on(corners, [pose_on_arc(side, curvature, way) for way in before], point)) > KEPT - STEP
    if found < longest:
        assert apart(corners, pose_on_arc(side, curvature, found), point) == pytest.approx(KEPT, abs=STEP)


@given(hulls, places, sides)
def test_it_is_the_polygon_turned_on_the_spot(corners, point, direction):
    hull = Polygon(corners)
    if hull.measure(alone(point))[0] <= KEPT + STEP:
        return
    found = hull.on_the_spot(alone(point), direction, KEPT, KEPT).distance
    poses = [(0.0, 0.0, direction * angle) for angle in np.arange(0.0, min(found, math.tau), WAY)]
    assert min(nearest_on(corners, poses, point)) > KEPT - STEP
    if found < math.inf:
        assert apart(corners, (0.0, 0.0, direction * found), point) == pytest.approx(KEPT, abs=STEP)


@given(hulls, places)
def test_a_distance_is_that_of_the_border_and_negative_inside(corners, point):
    measured = Polygon(corners).measure(alone(point))[0]
    assert abs(measured) == pytest.approx(apart(corners, (0.0, 0.0, 0.0), point), abs=STEP)
    if measured != 0.0:  # the border itself is neither inside nor outside
        assert (measured < 0.0) == Polygon(corners).covers(*alone(point))[0]


@given(hulls, st.lists(places, max_size=6), st.floats(0.01, 0.3))
def test_the_nearest_of_points_is_as_near_as_its_distance(corners, points, most):
    points = np.array(points).reshape(-1, 2).T
    for hull in (Polygon(corners), Disc(0.3)):
        assert hull.nearest(points, hull.rim + most) == hull.measure(points).min(initial=hull.rim + most)


@given(hulls, places, sides, curvatures)
def test_corners_may_go_either_way_round(corners, point, side, curvature):
    found, again = (
        Polygon(each).on_arc(alone(point), side, curvature, KEPT, KEPT) for each in (corners, corners[::-1])
    )
    assert found.point == again.point
    assert found.distance == pytest.approx(again.distance)


@given(hulls, st.floats(-math.pi, math.pi))
def test_a_point_of_the_rim_is_on_the_border_in_its_direction(corners, bearing):
    x, y = Polygon(corners).on_rim(np.array([bearing]))
    assert apart(corners, (0.0, 0.0, 0.0), (x[0], y[0])) < STEP
    assert math.remainder(math.atan2(y[0], x[0]) - bearing, math.tau) == pytest.approx(0.0, abs=1e-6)


@given(hulls, st.floats(-math.pi, math.pi), st.floats(0.001, KEPT - 0.001), sides, st.floats(-4.0, 4.0))
def test_what_is_near_already_never_comes_nearer(corners, bearing, near, side, curvature):
    x, y = Polygon(corners).on_rim(np.array([bearing])) * 1.0
    point = (x[0] + near * math.cos(bearing), y[0] + near * math.sin(bearing))
    first = apart(corners, (0.0, 0.0, 0.0), point)
    found = Polygon(corners).on_arc(alone(point), side, curvature, KEPT, KEPT).distance
    ways = np.arange(0.0, min(found, 0.5), WAY)
    if len(ways):
        poses = [pose_on_arc(side, curvature, way) for way in ways]
        assert min(nearest_on(corners, poses, point)) >= min(first, KEPT) - 2 * STEP


def test_a_corner_sweeps_what_stands_beside_a_rectangle():
    hull, post = Polygon(RECTANGLE), alone((0.30, 0.32))
    assert hull.on_arc(post, 1, 0.0, KEPT, KEPT).distance == math.inf
    assert hull.on_the_spot(post, 1, KEPT, KEPT).distance < math.radians(5)
    assert Disc(0.25).on_the_spot(post, 1, 0.31, 0.31).distance == math.inf


def test_a_wall_is_driven_along_at_the_clearance_and_not_turned_to():
    wall = np.stack([np.arange(-1.0, 1.0, 0.04), np.full(50, 0.28)])
    hull = Polygon(RECTANGLE)
    assert hull.on_arc(wall, 1, 0.0, KEPT, 0.03 - 1e-6).distance == math.inf
    assert hull.on_arc(wall, 1, 0.2, KEPT, 0.03 - 1e-6).distance == pytest.approx(0.0, abs=1e-3)
    assert hull.on_the_spot(wall, -1, KEPT, 0.03 - 1e-6).distance == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("side", "free"), [(1, 0.0), (-1, math.inf)])
def test_what_the_hull_covers_blocks_only_the_way_farther_in(side, free):
    assert Polygon(RECTANGLE).on_arc(alone((0.28, 0.0)), side, 0.0, KEPT, KEPT).distance == free


@pytest.mark.parametrize("side", [1, -1])
def test_what_the_hull_covers_beside_it_is_left_by_going_straight(side):
    assert Polygon(RECTANGLE).on_arc(alone((0.0, 0.24)), side, 0.0, KEPT, KEPT).distance == math.inf


def test_nothing_is_in_the_way_of_nothing():
    for curvature in (0.0, 1.0):
        assert Polygon(ELL).on_arc(np.empty((2, 0)), 1, curvature, KEPT, KEPT).distance == math.inf
    assert Polygon(ELL).on_the_spot(np.empty((2, 0)), 1, KEPT, KEPT).distance == math.inf


@pytest.mark.parametrize(
    ("corners", "error"),
    [
        (RECTANGLE[:2], "2 corners"),
        (((0.3, 0.2), (0.3, 0.2), (-0.3, 0.0)), "the same"),
        (tuple((x + 1.0, y) for x, y in RECTANGLE), "(0, 0), lies outside"),
        (((0.3, 0.3), (-0.3, -0.3), (0.3, -0.3), (-0.2, 0.4)), "two edges cross"),
        (RECTANGLE, ""),
        (ELL, ""),
    ],
)
def test_a_footprint_that_cannot_be_is_named(corners, error):
    found = footprint_error(corners)
    assert error in found
    assert bool(error) == bool(found)
