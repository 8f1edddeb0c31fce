"""A gate whose robot is a rectangle: its corners sweep when it turns, and what they would meet stops the turn."""

import math

import numpy as np
import pytest

from cliffscan.safety.hull import Polygon
from cliffscan.safety.pose2d import Pose2D
from cliffscan.services.gate.config import GateConfig
from tests.gate_drive import Drive
from tests.naive_hull import apart

RECTANGLE = ((0.30, 0.25), (0.30, -0.25), (-0.40, -0.25), (-0.40, 0.25))
LIMITS = GateConfig(footprint=RECTANGLE, start_free=0.7).limits()
TURN = 1.0  # [rad/s]


def rectangle(**limits):
    return Drive(**LIMITS._replace(**limits)._asdict())


def near(drive, points):
    """How near the hull is to the nearest of these points, by its slow twin; negative where it covers one."""
    hull = Polygon(RECTANGLE)
    local = drive.pose.from_world(np.array(points).T)
    assert not hull.covers(*local).any()
    return min(apart(RECTANGLE, drive.pose, point) for point in points)


def remember(drive, *points):
    """Something stands there, that a scan has shown before."""
    drive.safety._grid.occupy(np.array(points).T)


def test_nothing_near_a_rectangle_turns_as_fast_as_asked():
    drive = rectangle()
    drive.steady(0.0, TURN)
    assert drive.steady(0.0, TURN, ticks=1).allowed.angular == pytest.approx(TURN)


@pytest.mark.parametrize(
    ("post", "way"),
    [((0.10, 0.34), 1), ((-0.20, 0.34), -1), ((-0.48, 0.10), 1), ((0.38, 0.0), -1), ((0.30, -0.34), 1)],
)
def test_a_turn_ends_before_a_corner_meets_what_stands_there(post, way):
    drive = rectangle()
    drive.tick(0.0)
    remember(drive, post)
    drive.go(0.0, way * TURN, ticks=400)
    assert near(drive, [post]) > 0.03 - 1e-6
    decision = drive.tick(0.0, way * TURN)
    assert decision.rule == "obstacle"
    assert abs(decision.allowed.angular) < 0.05


def test_a_disc_turns_where_a_rectangle_may_not():
    for limits, turns in (({}, False), ({"footprint": (), "radius": 0.25}, True)):
        drive = rectangle(**limits)
        drive.tick(0.0)
        remember(drive, (0.28, 0.31))
        assert (drive.steady(0.0, TURN).allowed.angular == pytest.approx(TURN)) is turns


def test_a_rectangle_passes_a_door_that_its_turning_circle_does_not_fit():
    drive = rectangle()
    drive.tick(0.0)
    remember(drive, *((0.1 * step, side * 0.36) for step in range(-6, 20) for side in (1, -1)))
    assert drive.steady(0.3).allowed.linear == pytest.approx(0.3)
    assert drive.go(0.3, ticks=100).x > 0.5
    assert drive.steady(0.0, TURN, ticks=200).allowed.angular < 0.3


@pytest.mark.parametrize("way", [1, -1])
def test_a_robot_whose_tail_may_not_swing_goes_straight_on_until_it_may(way):
    drive = rectangle(start_free=2.0)
    drive.tick(0.0)
    wall = [(0.04 * step - 0.02, -way * 0.30) for step in range(-20, 1)]
    remember(drive, *wall)
    nearest = []
    for _ in range(60):
        drive.go(0.35, way * TURN, ticks=10)
        nearest.append(near(drive, wall))
    assert min(nearest) > 0.05 - 0.02 * math.sqrt(2)
    assert abs(drive.pose.theta) > math.radians(90.0)


WALLS = {
    "tail": [(-0.46, 0.04 * step) for step in range(-20, 21)],
    "nose": [(0.36, 0.04 * step) for step in range(-20, 21)],
    "flank": [(0.04 * step, -0.31) for step in range(-20, -6)],
}


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("wall", "asked"), [("tail", 0.35), ("nose", -0.35), ("flank", 0.35)])
def test_a_robot_beside_a_wall_goes_as_asked_until_it_may_turn(wall, asked, way):
    drive = rectangle(start_free=1.4)
    drive.tick(0.0)
    remember(drive, *WALLS[wall])
    while way * drive.pose.theta < math.radians(60.0) and drive.now < 106.0:
        drive.go(asked, way * TURN, ticks=10)
        assert near(drive, WALLS[wall]) > 0.03 - 1e-6
    assert way * drive.pose.theta >= math.radians(60.0)


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(
    ("wall", "slides", "asked"),
    [("tail", (-0.09, 0.0), 0.35), ("nose", (0.09, 0.0), -0.35), ("flank", (0.0, -0.08), 0.35)],
)
def test_a_robot_that_slid_against_a_wall_comes_away_and_turns(wall, slides, asked, way):
    drive = rectangle(start_free=1.4)
    drive.tick(0.0)
    remember(drive, *WALLS[wall])
    drive.pose = Pose2D(*slides, 0.0)
    drive.go(asked, way * TURN, ticks=300)
    assert way * drive.pose.theta > math.radians(60.0)
    assert near(drive, WALLS[wall]) > 0.0


def test_a_robot_that_is_to_turn_alone_does_not_go_on():
    drive = rectangle()
    drive.tick(0.0)
    remember(drive, *((0.04 * step - 0.02, -0.30) for step in range(-20, 1)))
    assert drive.go(0.0, TURN, ticks=200).x == 0.0


def test_a_robot_that_drives_brakes_before_it_turns_on_the_spot():
    drive = rectangle()
    drive.go(0.4, ticks=60)
    assert drive.tick(0.0, TURN).allowed == (0.0, 0.0)
    assert drive.steady(0.0, TURN).allowed.angular == pytest.approx(TURN)


def test_floor_that_was_never_seen_is_not_swept():
    drive = rectangle()
    drive.safety._grid.forget()
    drive.pose = Pose2D(0.0, 0.0, 0.0)
    decision = drive.steady(0.0, TURN)
    assert decision.allowed.angular == 0.0
    assert "unseen floor" in str(decision.obstruction)


def test_backward_it_keeps_to_floor_that_was_seen_where_a_disc_may_back_away():
    for limits, free in (({}, False), ({"footprint": (), "radius": 0.25}, True)):
        drive = rectangle(**limits)
        behind = -drive.go(-0.2, ticks=600).x
        assert (behind > 1.0) is free
        assert free or 0.1 < behind < LIMITS.start_free - 0.40


def test_a_robot_that_was_carried_may_turn_where_it_was_put_down():
    drive = rectangle()
    drive.tick(0.0)
    drive.sensors = {"drop": 3}
    drive.tick(0.0)
    drive.sensors = {}
    drive.tick(0.0)
    assert drive.steady(0.0, TURN).allowed.angular == pytest.approx(TURN)


def test_without_scans_a_turn_is_slow_and_meets_nothing():
    drive = rectangle()
    drive.tick(0.0)
    remember(drive, (0.28, 0.31))
    decision = drive.steady(0.0, TURN, scan=False)
    assert decision.rule == "no_scan"
    assert 0.0 <= decision.allowed.angular < 0.2
    assert math.isclose(drive.steady(0.0, -0.1, scan=False).allowed.angular, -0.1, abs_tol=0.2)


@pytest.mark.parametrize(
    ("settings", "error"),
    [
        ({"footprint": RECTANGLE}, "start_free: 0.5 m is less than the footprint needs to turn"),
        ({"footprint": RECTANGLE[:2], "start_free": 0.7}, "2 corners"),
    ],
)
def test_a_footprint_that_cannot_be_driven_is_refused_with_the_remedy(settings, error):
    with pytest.raises(ValueError, match=error):
        GateConfig(**settings)
