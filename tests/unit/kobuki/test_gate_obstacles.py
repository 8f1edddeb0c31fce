"""What is in the way, what is remembered, and what is not known."""

import math

import numpy as np
import pytest

from services.kobuki.ground import Pose
from services.kobuki.safety import REST
from tests.kobuki_gate import ANGLES, Drive


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
    drive.pose = Pose(0.0, 0.0, math.pi)
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
    drive.pose = Pose(0.3, 0.0, 0.0)
    drive.tick(0.0)
    drive.safety.restart(drive.pose)
    assert drive.go(0.3).x < 0.8 - 0.087 - 0.18


def test_at_speed_it_brakes_before_it_swerves_towards_something():
    drive = Drive(ranges=np.where(ANGLES > 0.2, 0.9, math.inf))
    for _ in range(100):
        drive.tick(0.7)
    before = drive.tick(0.7).allowed.linear
    assert before > 0.3
    decision = drive.steady(before, 1.5, ticks=10)
    assert decision.rule == "obstacle"
