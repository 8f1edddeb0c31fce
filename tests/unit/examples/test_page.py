"""The bytes in docs/slam.md are those of the real encoder."""

import math

import msgpack
import numpy as np

from cliffscan.common.contract.map_messages import Pose2D
from cliffscan.common.contract.messages import LaserScan
from examples.slam import wire
from examples.slam.pose import Pose
from tests.unit.examples import page

STAMP = 1_700_000_000_123_456_789
SCAN = {
    "seq": 7,
    "stamp": STAMP,
    "frame": "camera",
    "angle_min": -0.5,
    "angle_max": 0.5,
    "angle_increment": 0.5,
    "time_increment": 0.0,
    "scan_time": 0.03125,
    "range_min": 0.0,
    "range_max": 4.5,
    "ranges": np.array([1.5, math.inf, math.nan], "<f4").tobytes(),
    "intensities": np.array([2, 0, 0], "<f4").tobytes(),
    "clear": np.array([1.5, 4.0, 0.75], "<f4").tobytes(),
}


def test_the_scan_is_what_the_services_send():
    assert page.dumps()[0] == LaserScan.of(SCAN).encode() == msgpack.packb(SCAN)


def test_the_pose_is_what_a_plug_in_sends_and_anybody_reads():
    assert page.dumps()[1] == wire.write_pose(Pose(1.5, -0.25, 0.5), STAMP)
    assert Pose2D.decode(page.dumps()[1]).pose == (1.5, -0.25, 0.5)


def test_the_program_has_about_thirty_lines():
    assert len(list(filter(None, page.program().splitlines()))) <= 32
