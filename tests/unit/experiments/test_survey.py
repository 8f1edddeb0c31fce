"""A survey leads the robot, keeps what is said, and is done when the maps show all that was seen."""

import pytest

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from evaluation.processes.steering import Look
from experiments.survey import Survey

MAPS = ("fused", "positive")
SECOND = 1_000_000_000


class Said(list):
    """A publisher that keeps what it is given."""

    put = list.append


def odometry(heading, stamp):
    nothing = [0.0] * 9
    pose = (0.0, 0.0, heading)
    return Odometry(
        stamp=stamp,
        frame="odom",
        child_frame="base_link",
        pose=pose,
        twist=(0.0, 0.0),
        pose_covariance=nothing,
        twist_covariance=nothing,
    ).encode()


def grid(stamp):
    return OccupancyGrid(
        stamp=stamp, frame="map", resolution=0.05, width=1, height=1, origin=(0.0, 0.0, 0.0), data=b"\0"
    ).encode()


@pytest.fixture
def survey():
    return Survey([Look(90)], MAPS, Said())


def test_it_hears_all_that_it_needs(survey):
    assert set(survey.paths) == {"base/odom", "map/fused", "map/positive", "pose/fused", "pose/positive"}


def test_it_commands_now_and_then_once_it_may(survey):
    survey.receive("base/odom", odometry(0.0, SECOND), go=False)
    assert survey._publisher == []
    for stamp in range(SECOND, 2 * SECOND, SECOND // 50):
        survey.receive("base/odom", odometry(0.0, stamp), go=True)
    assert 8 <= len(survey._publisher) <= 14
    assert all(said.angular > 0.0 for said in survey._publisher)


def test_it_is_done_when_the_steps_are_and_every_map_is_newer(survey):
    survey.receive("map/fused", grid(SECOND), go=True)
    survey.receive("base/odom", odometry(1.57, 2 * SECOND), go=True)
    assert survey.done == 1
    for name in MAPS:
        survey.receive(f"map/{name}", grid(2 * SECOND - 1), go=True)
    assert survey.done == 1
    for name in MAPS:
        survey.receive(f"map/{name}", grid(2 * SECOND), go=True)
    assert survey.done == survey.total == 3


def test_poses_are_kept_by_stamp(survey):
    survey.receive("pose/fused", Pose2D(stamp=5, frame="map", pose=(1.0, 2.0, 3.0)).encode(), go=True)
    assert survey.poses == {"fused": {5: (1.0, 2.0, 3.0)}, "positive": {}}
