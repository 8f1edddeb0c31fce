"""From map to odom and on to the base is where the SLAM says the robot is."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.contract.map_messages import Pose2D as PoseOnMap
from cliffscan.safety.pose2d import Pose2D
from cliffscan.services.ros2.map_frame import ORIGIN, MapFrame
from cliffscan.services.ros2.transforms import heading_of
from tests.unit.ros2.test_messages import ODOMETRY

SECOND = 1_000_000_000  # [ns]
POSES = st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(-6, 6))


def frame_of(*moves):
    made = MapFrame()
    for stamp, pose in moves:
        made.moved(ODOMETRY.model_copy(update={"stamp": stamp, "pose": pose}))
    return made


@given(POSES, POSES)
def test_the_chain_ends_where_the_slam_says(on_odom, on_map):
    made = frame_of((SECOND, on_odom)).transform(PoseOnMap(stamp=SECOND, frame="map", pose=on_map))
    assert (made.parent, made.child, made.stamp) == ("map", "odom", SECOND)
    x, y, _ = made.translation
    end = Pose2D(x, y, heading_of(made.rotation)).then(Pose2D(*on_odom))
    assert end.x == pytest.approx(on_map[0], abs=1e-9)
    assert end.y == pytest.approx(on_map[1], abs=1e-9)
    assert math.cos(end.theta - on_map[2]) == pytest.approx(1.0)


@given(POSES)
def test_an_inverse_leads_back(pose):
    assert Pose2D(*pose).then(ORIGIN.seen_from(Pose2D(*pose))) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_the_odometry_of_the_poses_moment_counts():
    moving = frame_of((SECOND, (0.0, 0.0, 0.0)), (2 * SECOND, (1.0, 0.0, 0.0)))
    pose = PoseOnMap(stamp=SECOND + SECOND // 2, frame="map", pose=(5.0, 0.0, 0.0))
    assert moving.transform(pose).translation == pytest.approx((4.5, 0.0, 0.0))


@pytest.mark.parametrize("stamp", [0, 2 * SECOND])
def test_a_pose_of_another_time_is_nowhere(stamp):
    pose = PoseOnMap(stamp=stamp, frame="map", pose=(5.0, 0.0, 0.0))
    assert frame_of((SECOND, (0.0, 0.0, 0.0))).transform(pose) is None
