"""What no robot needs is refused before work is spent on it; what any robot may send is taken."""

import math
import re
import time
import tracemalloc
from pathlib import Path

import msgpack
import numpy as np
import pytest

from cliffscan.common.contract import limits, topics
from cliffscan.common.contract.base_messages import Imu, Odometry, Velocity
from cliffscan.common.contract.depth_codec import LEVELS, RAW, encode
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.message import MessageError, unpack
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus
from cliffscan.common.perception.combine import beams_with
from cliffscan.common.perception.scans import ImageScanConfig, laser_scan
from cliffscan.common.runtime.config import ConfigError, load
from tests import build

STAMP = build.SECOND
VELOCITY = {"stamp": STAMP, "linear": 0.1, "angular": 0.2}
ODOMETRY = {
    "stamp": STAMP,
    "frame": "odom",
    "child_frame": "base_link",
    "pose": [0.0, 0.0, 0.0],
    "twist": [0.0, 0.0],
    "pose_covariance": [0.0] * 9,
    "twist_covariance": [0.0] * 9,
}
IMU = {
    "stamp": STAMP,
    "frame": "gyro_link",
    "heading": 0.0,
    "heading_rate": 0.0,
    "sample_stamps": [STAMP],
    "angular_velocities": bytes(12),
}
GRID = {
    "stamp": STAMP,
    "frame": "map",
    "resolution": 0.05,
    "width": 2,
    "height": 2,
    "origin": [0.0, 0.0, 0.0],
    "data": bytes(4),
}
GOOD = {
    DepthImage: build.depth_fields(),
    LaserScan: build.scan_fields(),
    ServiceStatus: build.status_fields(),
    Velocity: VELOCITY,
    Odometry: ODOMETRY,
    Imu: IMU,
    OccupancyGrid: GRID,
}
ABSURD = [
    (DepthImage, "range", [0.5, 1e308]),
    (DepthImage, "range", [500.0, 4500.0]),
    (DepthImage, "range", [70.0, 80.0]),
    (DepthImage, "range", [0.0, 1e-300]),
    (DepthImage, "floor", [0.0, -1.0, 0.0, 1e-300]),
    (DepthImage, "frame", "x" * 257),
    (LaserScan, "angle_min", 1e300),
    (LaserScan, "angle_max", -1e300),
    (LaserScan, "angle_increment", 5e-324),
    (LaserScan, "angle_increment", 1e300),
    (LaserScan, "range_max", 1e300),
    (LaserScan, "range_max", 1e-300),
    (LaserScan, "scan_time", 1e300),
    (ServiceStatus, "counts", {str(number): 1 for number in range(257)}),
    (ServiceStatus, "note", "x" * 1001),
    (ServiceStatus, "latency", [0.0, 1e300]),
    (Velocity, "linear", 1e300),
    (Velocity, "angular", -1e300),
    (Velocity, "source", "x" * 257),
    (Odometry, "pose", [1e308, 0.0, 0.0]),
    (Odometry, "pose", [0.0, 0.0, 1e300]),
    (Odometry, "pose_covariance", [1e300] * 9),
    (Imu, "sample_stamps", [STAMP] * 1025),
    (Imu, "angular_velocities", bytes(8)),
    (Imu, "angular_velocities", np.full(3, np.nan, "<f4").tobytes()),
    (OccupancyGrid, "resolution", 5e-324),
    (OccupancyGrid, "resolution", 1e300),
    (OccupancyGrid, "origin", [1e308, 0.0, 0.0]),
]


@pytest.mark.parametrize(("kind", "field", "value"), ABSURD)
def test_an_absurd_number_is_refused_by_name(kind, field, value):
    kind.decode(build.payload(GOOD[kind]))
    with pytest.raises(MessageError, match=field):
        kind.decode(build.payload(GOOD[kind] | {field: value}))


def test_a_range_in_millimetres_is_told_how_to_be_right():
    with pytest.raises(MessageError, match="millimetres"):
        DepthImage.decode(build.payload(build.depth_fields(range=[500.0, 4500.0])))


@pytest.mark.parametrize("beams", [16, 360, 1440, 20_000])
@pytest.mark.parametrize("first", [0.0, -math.pi, -2.0])
def test_a_lidar_of_any_make_is_taken(beams, first):
    step = 2 * math.pi / beams
    made = build.scan(np.full(beams, 100.0), angle_min=first, increment=step, range_max=300.0)
    assert len(made.ranges) == beams


def test_more_beams_than_any_lidar_has_are_refused():
    with pytest.raises(MessageError, match="20001 beams"):
        build.scan(np.ones(20_001), increment=1e-5)


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1920, 1080), (4096, 512)])
@pytest.mark.parametrize("encoding", [RAW, LEVELS])
def test_the_largest_frame_fits_however_little_it_can_be_compressed(width, height, encoding):
    pixels = np.random.default_rng(1).integers(0, 65536, (height, width)).astype(np.uint16)
    fields = build.depth_fields(
        width=width,
        height=height,
        encoding=encoding,
        data=encode(pixels, encoding),
        intrinsics=[width, height, width / 2, height / 2],
    )
    np.testing.assert_array_equal(DepthImage.decode(build.payload(fields)).depth, pixels)


def test_the_largest_map_and_the_largest_scan_fit():
    fields = GRID | {"width": 4096, "height": 4096, "data": bytes(limits.MOST_CELLS)}
    assert len(OccupancyGrid.decode(build.payload(fields)).data) == limits.MOST_CELLS
    every = np.ones(20_000)
    assert len(build.scan(every, every, every, increment=1e-4).clear) == 20_000


def cost(kind, payload):
    """Bytes, and seconds of the processor, that it takes to refuse a payload."""
    tracemalloc.start()
    began = time.thread_time()
    try:
        with pytest.raises(MessageError, match="bytes"):
            kind.decode(payload)
        return tracemalloc.get_traced_memory()[1], time.thread_time() - began
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("kind", GOOD)
def test_a_payload_beyond_its_kind_is_not_unpacked(kind):
    payload = build.payload(GOOD[kind] | {"more": [0] * (limits.PAYLOAD.get(kind.__name__, limits.SMALL) + 1)})
    memory, seconds = cost(kind, payload)
    assert memory < 10_000
    assert seconds < 0.1


@pytest.mark.parametrize("filling", [b"\x90", b"\x80", b"\xc0", b"\x91\x90"])
def test_a_large_payload_of_anything_but_bin_is_not_unpacked(filling):
    """An empty list takes one byte of a payload and 56 of memory."""
    count = 4_000_000 // len(filling)
    payload = b"\x81\xa4more\xdd" + count.to_bytes(4, "big") + filling * count
    memory, _ = cost(DepthImage, payload)
    assert memory < 8_000_000  # msgpack's copy of the payload; without a limit 200 MB


def test_a_request_has_the_size_of_a_small_message():
    with pytest.raises(MessageError, match="expected 32768 at most"):
        unpack(msgpack.packb({"led": [1] * 40_000}))


@pytest.mark.parametrize(
    ("path", "most"),
    [
        ("camera/depth", limits.PAYLOAD["DepthImage"]),
        ("scan/lidar", limits.PAYLOAD["LaserScan"]),
        ("map/positive", limits.PAYLOAD["OccupancyGrid"]),
        ("base/cmd_vel", limits.SMALL),
        ("status/fuse", limits.SMALL),
        ("somebody/elses", limits.LARGEST),
    ],
)
def test_a_keys_payload_is_limited_by_its_message(path, most):
    assert topics.most_bytes(path) == most


def test_the_page_tells_the_limits_that_hold():
    page = (Path(__file__).parents[3] / "common/README.md").read_text()
    told = dict(re.findall(r"^\| payload of an? (\w+) \| (\d+) bytes \|$", page, re.MULTILINE))
    assert {name: int(most) for name, most in told.items()} == limits.PAYLOAD
    for value in (limits.SMALL, limits.MOST_PIXELS, limits.MOST_SIDE, limits.MOST_BEAMS, limits.MOST_CELLS):
        assert re.search(rf"\b{value}\b", page), value


@pytest.mark.parametrize("setting", ["range_max=1e300", "range_max=1e-9", "field_of_view=1e-9", "scan_time=1e300"])
def test_no_setting_makes_scans_that_are_refused(setting):
    with pytest.raises(ConfigError, match=setting.split("=")[0]):
        load("positive", ImageScanConfig, None, [f"scan.{setting}"])


def test_what_a_service_makes_of_the_oddest_camera_is_no_malformed_scan():
    view = build.camera(width=2, height=2, focal=200.0, mount=(0.001, math.radians(87), 0.0), reach=(0.0, 0.001))
    image = DepthImage.pack(1, STAMP, "f", np.full((2, 2), 1, np.uint16), view, RAW)
    scan = laser_scan(image, beams_with(np.full(640, np.inf, np.float32), 1.0), ImageScanConfig())
    assert LaserScan.decode(scan.encode()).range_max == scan.range_max
