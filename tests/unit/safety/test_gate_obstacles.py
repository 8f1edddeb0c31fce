"""What is in the way, what is remembered, and what is not known."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.description import CameraDescription
from cliffscan.safety.inputs import REST
from cliffscan.safety.pose2d import Pose2D
from tests.gate_drive import ANGLES, LIMITS, TICK, Drive


@pytest.mark.parametrize("far", [0.1, 0.3, 0.6])
def test_forward_only_is_blocked(far):
    drive = Drive(ranges=far)
    drive.steady(0.0)
    if far < 0.4:
        assert drive.tick(0.3).allowed == REST
    assert drive.steady(0.0, 1.0).allowed == (0.0, 1.0)
    drive.steady(0.0)
    assert drive.steady(-0.2).allowed == (-0.2, 0.0)


def test_it_does_not_back_over_an_edge_that_it_remembers():
    edge = 1.0
    drive = Drive(ranges=edge)
    drive.tick(0.0)
    drive.ranges = math.inf
    drive.pose = Pose2D(0.0, 0.0, math.pi)
    pose = drive.go(-0.3)
    assert 0.2 < pose.x < edge - 0.087 - 0.18


def test_an_edge_that_leaves_the_view_stops_it():
    def edge(pose):
        distance = 1.4 - (pose.x - 0.087)
        return distance / np.cos(ANGLES) if distance > 0.75 else math.inf

    assert 1.4 - 0.28 < Drive().go(0.5, ranges=edge).x < 1.4 - 0.18


def test_unseen_floor_stops_it_at_the_verified_floor():
    def then_nothing(pose):
        return math.inf if pose.x < 0.3 else math.nan

    assert Drive(ranges=math.nan).go(0.5).x < 0.5 - 0.18
    assert 1.0 < Drive().go(0.5, ranges=then_nothing).x < 0.3 + 1.5 - 0.18


@pytest.mark.parametrize("turn", [0.0, math.pi / 2, math.pi, -2.0])
@pytest.mark.parametrize("before", [0.0, 0.3, 0.6, 1.0])
def test_open_floor_never_holds_it_back(turn, before):
    drive = Drive()
    drive.go(0.3, ticks=round(before / 0.006))
    for _ in range(200):
        drive.pose = drive.pose._replace(theta=drive.pose.theta + turn / 200)
        drive.tick(0.0, 0.5)
    assert drive.go(0.3, ticks=100)
    assert drive.tick(0.3).allowed == pytest.approx((0.3, 0.0))


def test_a_corridor_does_not_hold_it_back():
    def walls(pose):
        with np.errstate(divide="ignore"):
            return 0.4 / np.abs(np.sin(ANGLES))

    assert Drive().go(0.3, ranges=walls).x > 1.4


def test_after_a_gap_an_edge_is_still_there():
    drive = Drive(ranges=0.8)
    drive.steady(0.0)
    drive.ranges = math.inf
    drive.pose = Pose2D(0.3, 0.0, 0.0)
    drive.tick(0.0)
    drive.safety.restart(drive.pose)
    assert drive.go(0.3).x < 0.8 - 0.087 - 0.18


@pytest.mark.parametrize("away", [0.6, 1.2, 2.9, math.inf])
@pytest.mark.parametrize("speed", [0.3, 0.5, 0.7])
def test_an_edge_for_which_it_braked_is_not_driven_over_after_a_gap_in_which_it_rolled_on(speed, away):
    edge, drive, rolled = 3.0, Drive(), 0.0

    def look():
        """What is nearer than the camera sees is reported where it begins to."""
        distance = edge - (drive.pose.x + rolled - 0.087)
        drive.ranges = np.where(distance < 4.0, np.maximum(distance / np.cos(ANGLES), 0.75), math.inf)

    fastest = 0.0
    for _ in range(1000):
        look()
        allowed = drive.tick(speed).allowed.linear
        if allowed < fastest - 1e-3:
            break
        fastest = allowed
        drive.pose = drive.pose.then(Pose2D(allowed * TICK, 0.0, 0.0))
    rolled = min(edge - 0.18 - 0.03 - drive.pose.x, fastest * away)  # and rests just before the edge at the latest
    drive.now += min(away, 60.0)
    drive.safety.lose_base()
    drive.safety.restart(drive.pose, away)
    for _ in range(600):
        look()
        drive.pose = drive.pose.then(Pose2D(drive.tick(0.3).allowed.linear * TICK, 0.0, 0.0))
    assert drive.pose.x + rolled < edge - 0.18


def test_after_a_short_gap_a_robot_that_stood_goes_on():
    drive = Drive()
    drive.steady(0.0)
    drive.safety.restart(drive.pose, 0.6)
    assert drive.go(0.3).x > 0.5


def test_the_older_the_pose_the_slower_it_goes_on():
    drive = Drive(ranges=0.8)
    drive.steady(0.7)
    speeds = [drive.safety.decide(drive.command, drive.now, late=late).allowed.linear for late in (0.0, 0.1, 0.2)]
    assert speeds[0] > speeds[1] > speeds[2] > 0.0


def test_what_another_camera_saw_is_not_free():
    drive = Drive()
    drive.steady(0.0)
    aside = CameraDescription(
        frame="", simulated=True, nearest_floor=0.72, farthest=4.0, field_of_view=(-0.5, 0.5), y=0.1, yaw=math.pi / 2
    )
    drive.safety.describe(aside)
    assert drive.go(0.3).x < LIMITS.start_free


def test_at_speed_it_brakes_before_it_swerves_towards_something():
    drive = Drive(ranges=np.where(ANGLES > 0.2, 0.9, math.inf))
    for _ in range(100):
        drive.tick(0.7)
    before = drive.tick(0.7).allowed.linear
    assert before > 0.3
    decision = drive.steady(before, 1.5, ticks=10)
    assert decision.rule == "obstacle"


def wall(distance):
    """A wall on the left, parallel to the x axis, as it is seen from anywhere."""

    def ranges(pose):
        rise = np.sin(ANGLES + pose.theta)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(rise > 0.0, (distance - pose.y + 0.087 * math.sin(pose.theta)) / rise, math.inf)

    return ranges


@pytest.mark.parametrize("angular", [1.0, -1.0])
def test_before_a_wall_it_turns_on(angular):
    drive = Drive(ranges=0.3)
    assert drive.steady(0.3, angular).allowed == (0.0, angular)


def test_a_turn_leads_out_of_a_corner():
    def corner(pose):
        x, y = pose.x - 0.087 * math.cos(pose.theta), pose.y - 0.087 * math.sin(pose.theta)
        dx, dy = np.cos(ANGLES + pose.theta), np.sin(ANGLES + pose.theta)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.minimum(np.where(dx > 0, (0.9 - x) / dx, math.inf), np.where(dy > 0, (0.4 - y) / dy, math.inf))

    drive = Drive()
    drive.go(0.3, ranges=corner)
    assert 0.5 < drive.pose.x < 0.9 - 0.18
    drive.go(0.3, -0.8, ticks=180, ranges=corner)
    assert drive.pose.theta < -1.5
    assert drive.go(0.3, ticks=150, ranges=corner).y < -0.4


@pytest.mark.parametrize("distance", [0.22, 0.26])
def test_along_a_near_wall_it_drives_on_and_comes_no_nearer(distance):
    drive = Drive()
    drive.pose = Pose2D(0.0, -0.3, 0.0)
    drive.go(0.0, ticks=2, ranges=wall(distance))
    drive.go(0.3, ticks=120, ranges=wall(distance))
    drive.pose = Pose2D(drive.pose.x, 0.0, 0.0)  # somebody pushed it nearer
    start = drive.pose.x
    assert drive.go(0.3, ticks=90, ranges=wall(distance)).x > start + 0.2
    drive.go(0.3, 0.1, ticks=150, ranges=wall(distance))
    assert drive.pose.y <= 0.02


@pytest.mark.parametrize("kind", ["bumper", "cliff"])
def test_it_does_not_back_off_over_an_edge_that_it_remembers(kind):
    drive = Drive(ranges=1.0)
    drive.tick(0.0)
    drive.ranges = math.inf
    drive.pose = Pose2D(0.4, 0.0, math.pi)
    drive.sensors = {kind: 2}
    pose = drive.go(0.3, ticks=400)
    assert 0.5 < pose.x < 1.0 - 0.087 - 0.18
    decision = drive.tick(0.3)
    assert decision[:2] == (kind, REST)
    assert decision.note == "something is behind"
    drive.sensors = {}
    drive.tick(0.0)
    assert drive.steady(0.0, 1.0).allowed == (0.0, 1.0)


def test_after_it_was_carried_it_looks_around_before_it_drives():
    drive = Drive(ranges=1.0)
    drive.steady(0.0)
    drive.ranges = math.inf
    drive.sensors = {"drop": 3}
    drive.steady(0.3)
    drive.sensors = {}
    assert drive.steady(0.3).allowed == REST
    drive.go(0.0, 1.0, ticks=350)
    drive.go(0.0)
    assert drive.steady(0.3).allowed == (0.3, 0.0)


def test_a_wheel_over_a_step_makes_it_forget_nothing():
    drive = Drive(ranges=0.8)
    drive.steady(0.0)
    drive.sensors = {"drop": 1}
    drive.tick(0.3)
    drive.ranges = math.inf
    drive.steady(0.3)
    drive.sensors = {}
    drive.pose = Pose2D(0.3, 0.0, 0.0)
    assert drive.go(0.3).x < 0.8 - 0.087 - 0.18


def test_scans_taken_with_a_wheel_in_the_air_show_nothing():
    drive = Drive()
    drive.steady(0.0)
    drive.sensors = {"drop": 1}
    drive.tick(0.0)
    drive.ranges = 1.0
    drive.steady(0.0)
    tilted = drive.now
    drive.sensors = {}
    drive.tick(0.0, scan=False)
    drive.tick(0.0, taken=tilted)
    assert not drive.safety._grid.not_free(drive.pose, 1.2, unknown_too=False).size
