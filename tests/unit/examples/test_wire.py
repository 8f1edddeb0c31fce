"""What the examples read and write is what the project's own messages are."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.description import TURTLEBOT_2, CameraDescription, Place, RobotDescription
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.messages import LaserScan
from examples.slam import wire
from examples.slam.pose import Pose
from tests import build
from tests.unit.examples.room import START, odometry_fields, payload, scan_fields

RANGES, EVIDENCE = [1.0, np.inf, np.nan], [2.0, 0.0, 0.0]
SCAN = scan_fields(RANGES, EVIDENCE)


def test_a_scan_of_the_services_is_read():
    scan = wire.read_scan(LaserScan.of(SCAN).encode())
    assert (scan.stamp, scan.range_min, scan.range_max) == (START, 0.0, 4.5)
    assert_array_equal(scan.ranges, np.float32(RANGES))
    assert_array_equal(scan.evidence, EVIDENCE)
    assert scan.angles == pytest.approx(LaserScan.of(SCAN).grid().angles())


def test_a_scan_may_be_without_evidence():
    assert not len(wire.read_scan(payload(SCAN | {"intensities": b""})).evidence)


def test_odometry_of_the_base_is_read():
    read = wire.read_odometry(Odometry.of(odometry_fields(Pose(1.0, -2.0, 0.5))).encode())
    assert read == wire.Odometry(START, Pose(1.0, -2.0, 0.5))


def test_the_camera_of_a_description_is_read():
    camera = build.camera()
    place = Place(0.1, -0.2, 0.3)
    sent = RobotDescription(stamp=START, camera=CameraDescription.of(camera, "eye", simulated=True, place=place))
    assert wire.read_camera(sent.encode()) == wire.Camera(Pose(*place), sent.camera.nearest_floor)
    assert wire.read_camera(RobotDescription(stamp=START).encode()) is None
    assert wire.UNDESCRIBED.place == Pose(*TURTLEBOT_2)


def test_a_map_is_one_for_the_project():
    cells = np.array([[-1, 0, 100], [50, 7, -1]], np.int8)
    grid = OccupancyGrid.decode(wire.write_map(wire.Map(0.05, -1.0, 2.0, cells), START))
    assert (grid.stamp, grid.frame, grid.resolution, grid.origin) == (START, "map", 0.05, (-1.0, 2.0, 0.0))
    assert_array_equal(grid.data.reshape(grid.height, grid.width), cells)


def test_a_map_of_a_part_of_a_picture_keeps_its_rows():
    cells = np.arange(12, dtype=np.int8).reshape(3, 4)[:, 1:3]
    assert OccupancyGrid.decode(wire.write_map(wire.Map(0.05, 0, 0, cells), START)).data.tolist() == [1, 2, 5, 6, 9, 10]


def test_a_pose_is_one_for_the_project():
    pose = Pose2D.decode(wire.write_pose(Pose(1.5, -0.25, 0.5), START))
    assert (pose.stamp, pose.frame, pose.pose) == (START, "map", (1.5, -0.25, 0.5))


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"stamp": "now"}, "stamp"),
        ({"angle_min": None}, "angle_min"),
        ({"angle_increment": np.nan}, "angle_increment"),
        ({"range_max": "far"}, "range_max"),
        ({"ranges": b"123"}, "ranges"),
        ({"ranges": [1.0, 2.0, 3.0]}, "ranges"),
        ({"ranges": b"", "intensities": b""}, "0 ranges"),
        ({"intensities": b"1234"}, "1 intensities"),
        ({"clear": b"1234"}, "1 clear"),
        ({"clear": np.float32([1.0, np.nan, 1.0]).tobytes()}, "clear"),
    ],
)
def test_a_bad_scan_is_refused(change, word):
    with pytest.raises(wire.WireError, match=word):
        wire.read_scan(payload(SCAN | change))


@pytest.mark.parametrize("pose", [None, [1.0, 2.0], [1.0, 2.0, np.inf], [1.0, "2", 3.0]])
def test_bad_odometry_is_refused(pose):
    with pytest.raises(wire.WireError, match="pose"):
        wire.read_odometry(payload(odometry_fields(Pose()) | {"pose": pose}))


@pytest.mark.parametrize("garbage", [b"", b"\xc1", b"\x93\x01\x02\x03", b"\x81"])
def test_garbage_is_refused(garbage):
    with pytest.raises(wire.WireError):
        wire.read_scan(garbage)
