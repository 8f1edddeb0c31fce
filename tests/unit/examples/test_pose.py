"""Poses follow one another, and the way back leads back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from examples.slam.pose import Pose, wrapped

LENGTHS = st.floats(-50, 50)
ANGLES = st.floats(-math.pi, math.pi)
POSES = st.builds(Pose, LENGTHS, LENGTHS, ANGLES)


def near(pose, other):
    return pose[:2] == pytest.approx(other[:2], abs=1e-9) and abs(wrapped(pose.theta - other.theta)) < 1e-9


def test_a_step_is_seen_from_where_it_begins():
    assert near(Pose(1, 2, math.pi / 2).then(Pose(3, 0, 0.5)), Pose(1, 5, math.pi / 2 + 0.5))


@given(POSES, POSES)
def test_the_step_to_a_pose_leads_there(here, there):
    assert near(here.then(here.step_to(there)), there)


@given(POSES, POSES)
def test_between_two_poses_lie_both(here, there):
    assert near(here.towards(there, 0.0), here)
    assert near(here.towards(there, 1.0), there)


def test_the_shorter_turn_is_taken():
    assert near(Pose(0, 0, math.pi - 0.1).towards(Pose(2, 4, 0.1 - math.pi), 0.5), Pose(1, 2, math.pi))
