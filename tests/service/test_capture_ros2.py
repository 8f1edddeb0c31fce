"""capture takes the depth topic of a ROS 2 driver, which a peer that knows rmw_zenoh's wire stands for."""

import io
import struct
import threading
import time

import numpy as np
import pytest
import zenoh
import zenoh.ext
from PIL import Image

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.messages import DepthImage
from tests import scenes
from tests.ros2_peer import ROS, Peer, key_of
from tests.service.conftest import intensities, ranges

MOUNT = FloorPlane.from_mount(0.45, 0.2)
CAMERA = scenes.camera(320, 240, MOUNT)
SCENE = scenes.depth(CAMERA, wall=3.0)
OPTICAL = "camera_depth_optical_frame"
IMAGE, COMPRESSED, INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/CameraInfo"
TF = "tf2_msgs/msg/TFMessage"
TOPIC = "camera/depth/image_rect_raw"
LEVEL = (-0.5, 0.5, -0.5, 0.5)  # from an optical frame to one with x ahead


def header(stamp):
    time_of = ROS.types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
    return ROS.types["std_msgs/msg/Header"](time_of, OPTICAL)


def image(stamp, depth, **changes):
    encoding = "32FC1" if depth.dtype == np.float32 else "16UC1"
    data = depth.view(np.uint8).ravel()
    fields = {"header": header(stamp), "height": depth.shape[0], "width": depth.shape[1], "encoding": encoding}
    fields |= {"is_bigendian": 0, "step": depth.strides[0], "data": data}
    return ROS.types[IMAGE](**(fields | changes))


def compressed(stamp, depth):
    """As compressed_depth_image_transport's encoder: millimetres as they are, or the quantised inverse of metres."""
    a, b, levels = 0.0, 0.0, depth
    if depth.dtype == np.float32:
        a = 100.0 * 101.0  # its default quantisation, up to 10 m
        b = 1.0 - a / 10.0
        with np.errstate(divide="ignore", invalid="ignore"):
            levels = np.where(depth > 0, a / depth + b + 0.5, 0).astype(np.uint16)
    told = f"{'32FC1' if a else '16UC1'}; compressedDepth png"
    content = io.BytesIO()
    Image.fromarray(levels).save(content, "PNG")
    data = np.frombuffer(struct.pack("<iff", 1, a, b) + content.getvalue(), np.uint8)
    return ROS.types[COMPRESSED](header(stamp), told, data)


def info(stamp, camera=CAMERA):
    fx, fy, cx, cy = camera.intrinsics
    k, p = np.array([fx, 0, cx, 0, fy, cy, 0, 0, 1.0]), np.array([fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1.0, 0])
    region = ROS.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    turn = np.eye(3).ravel()
    sizes = header(stamp), camera.height, camera.width
    return ROS.types[INFO](*sizes, "plumb_bob", np.zeros(5), k, turn, p, 0, 0, region)


def transform(parent, child, translation, rotation):
    vector, turn = ROS.types["geometry_msgs/msg/Vector3"], ROS.types["geometry_msgs/msg/Quaternion"]
    moved = ROS.types["geometry_msgs/msg/Transform"](vector(*translation), turn(*rotation))
    time_of = ROS.types["builtin_interfaces/msg/Time"](0, 0)
    head = ROS.types["std_msgs/msg/Header"](time_of, parent)
    return ROS.types["geometry_msgs/msg/TransformStamped"](head, child, moved)


class Driver(Peer):
    """A camera's driver: its pictures and CameraInfo at 30 Hz, its transforms once."""

    def __init__(self, *place) -> None:
        """place: as of a Peer."""
        super().__init__(*place)
        self.depth, self.make, self.topic, self.kind = SCENE, image, TOPIC, IMAGE
        self.metres, self.changes, self.info = False, {}, info
        self.stamps = []
        self._ended, self._thread, self._latched = threading.Event(), None, []

    def begin(self):
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self):
        dice = np.random.default_rng(1)
        while not self._ended.wait(1 / 30):
            stamp = time.time_ns()
            depth = np.where(self.depth > 0, self.depth + dice.integers(0, 2, self.depth.shape), 0).astype(np.uint16)
            if self.metres:
                depth = np.where(depth > 0, depth / np.float32(1000), np.float32(np.nan))
            if self.info:
                self.publish("camera/depth/camera_info", INFO, self.info(stamp))
            self.stamps.append(stamp)
            self.publish(self.topic, self.kind, self.make(stamp, depth, **self.changes))

    def latch(self, name, kind, message):
        """Publish what whoever subscribes later gets, too."""
        cache, detection = (
            zenoh.ext.CacheConfig(1),
            zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=0.5),
        )
        self._latched.append(
            zenoh.ext.declare_advanced_publisher(
                self.session, key_of(name, kind), cache=cache, sample_miss_detection=detection, publisher_detection=True
            )
        )
        payload = bytes(ROS.serialize_cdr(message, kind))
        self._latched[-1].put(payload, attachment=struct.pack("<qqB16s", 1, time.time_ns(), 16, bytes(16)))

    def stop(self):
        if self._thread:
            self._ended.set()
            self._thread.join()
            self._ended.clear()
            self._thread = None

    def close(self):
        self.stop()
        super().close()


@pytest.fixture
def driver(client):
    made = Driver(client.endpoint)
    yield made
    made.close()


def capture(start, *settings, **options):
    mount = ("capture.height=0.45", "capture.pitch=11.459")
    words = [word for each in ("capture.source=ros2", *mount, *settings) for word in ("--set", each)]
    return start("capture", *words, **options)


def test_a_depth_topic_becomes_camera_depth(client, start, driver):
    frames = client.listen("camera/depth")
    driver.begin()
    capture(start)
    frames.get()
    got = frames.get()
    assert got["stamp"] in driver.stamps
    assert got["intrinsics"] == pytest.approx(CAMERA.intrinsics)
    assert 0 < got["period"] < 10.0
    assert np.abs(DepthImage.of(got).depth.astype(int) - SCENE).max() <= 1
    assert got["floor"] == pytest.approx(CAMERA.floor, abs=0.02)


@pytest.mark.parametrize("metres", [False, True], ids=["16UC1", "32FC1"])
def test_a_compressed_topic_becomes_camera_depth(client, start, driver, metres):
    driver.make, driver.kind, driver.topic, driver.metres = compressed, COMPRESSED, f"{TOPIC}/compressedDepth", metres
    frames = client.listen("camera/depth")
    driver.begin()
    capture(start, f"capture.topic=/{driver.topic}", wait=False)
    assert np.abs(DepthImage.of(frames.get()).depth.astype(int) - SCENE).max() <= (5 if metres else 1)


def test_metres_become_a_fused_scan(client, start, driver):
    for service in ("negative", "positive", "fuse"):
        start(service, wait=False)
    for service in ("negative", "positive", "fuse"):
        client.wait_alive(service)
    driver.metres = True
    scans = client.listen("scan/fused")
    capture(start, wait=False)
    driver.begin()
    scan = scans.get()
    ahead = slice(310, 330)
    assert ranges(scan)[ahead] == pytest.approx(np.full(20, 3.0), abs=0.05)
    assert set(intensities(scan)[ahead]) == {1}


def test_the_mount_is_that_of_the_static_transforms_through_all_joints(client, start, driver):
    pitch = 0.2
    joints = [
        transform("base_footprint", "base_link", (0.0, 0.0, 0.05), (0.0, 0.0, 0.0, 1.0)),
        transform("base_link", "camera_link", (0.12, 0.03, 0.4), (0.0, np.sin(pitch / 2), 0.0, np.cos(pitch / 2))),
    ]
    driver.latch("tf_static", TF, ROS.types[TF](joints))
    driver.latch("tf_static", TF, ROS.types[TF]([transform("camera_link", OPTICAL, (0.0, 0.0, 0.0), LEVEL)]))
    described = client.listen("description")
    driver.begin()
    capture(start, "capture.height=0.3", "capture.pitch=0")
    camera = described.get()["camera"]
    assert (camera["height"], camera["pitch"], camera["roll"]) == pytest.approx((0.45, 0.2, 0.0))
    assert (camera["x"], camera["y"], camera["yaw"]) == pytest.approx((0.12, 0.03, 0.0))
    assert camera["simulated"] is False


def test_a_topic_that_stops_is_waited_for(client, start, driver):
    frames = client.listen("camera/depth")
    driver.begin()
    process = capture(start)
    driver.stop()
    client.wait_alive("capture", alive=False)
    process.wait_said("no image on /camera/depth/image_rect_raw in domain 0 for 3")
    process.wait_said("start the camera's driver")
    frames.all()
    driver.begin()
    client.wait_alive("capture")
    assert frames.get()["stamp"] in driver.stamps


def test_an_image_that_lies_is_dropped_alone(client, start, driver):
    frames = client.listen("camera/depth")
    driver.begin()
    process = capture(start)
    for changes, why in LIES.items():
        driver.changes = dict(changes)
        process.wait_said(why)
        driver.changes = {}
        last = driver.stamps[-1]
        assert frames.until(lambda frame, last=last: frame["stamp"] > last)
    assert "source_lost" not in process.said


LIES = {
    (("step", 1),): "step 1 for 320 pixels 16UC1, expected 640",
    (("height", 239),): "the image has 320x239 pixels, its CameraInfo 320x240",
    (("is_bigendian", 1),): "big-endian",
    (("encoding", "rgb8"),): "'rgb8' is no depth",
    (("step", 642),): "153600 bytes, expected 240 rows of 642",
}


def test_an_image_without_camera_info_is_told(client, start, driver):
    driver.info = None
    driver.begin()
    process = capture(start, wait=False)
    process.wait_said("no CameraInfo on /camera/depth/camera_info: have the driver publish it beside the image")
    driver.info = info
    client.wait_alive("capture")


def test_a_camera_that_changes_its_size_is_another_camera(client, start, driver):
    frames = client.listen("camera/depth")
    driver.begin()
    process = capture(start)
    assert frames.get()["width"] == 320
    small = scenes.camera(160, 120, MOUNT)
    driver.depth, driver.info = scenes.depth(small, wall=3.0), lambda stamp: info(stamp, small)
    got = frames.until(lambda frame: frame["width"] == 160)
    assert got["intrinsics"] == pytest.approx(small.intrinsics)
    assert "source_lost" not in process.said


def test_bytes_that_are_no_message_do_no_harm(client, start, driver):
    frames, status = client.listen("camera/depth"), client.listen("status/capture")
    driver.begin()
    capture(start)
    names = {TOPIC: IMAGE, "camera/depth/camera_info": INFO, "tf_static": TF}
    for name, kind in names.items():
        for payload in (b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 64, b"\x01\x00"):
            driver.session.put(key_of(name, kind), payload, congestion_control=zenoh.CongestionControl.BLOCK)
    assert status.until(lambda each: each["counts"].get("malformed", 0) >= 3)
    frames.all()
    assert frames.get()["stamp"] in driver.stamps


def test_the_node_is_in_the_graph_as_long_as_capture_runs(client, start, driver):
    driver.begin()
    process = capture(start, "capture.topic=/camera/depth/image_rect_raw")
    tokens = driver.tokens_when(lambda all_of: any(token[5] == "NN" for token in all_of))
    assert {token[8] for token in tokens} == {"cliffscan_capture"}
    assert {(token[9], token[10].split("::")[-1]) for token in tokens if token[5] == "MS"} == {
        ("%camera%depth%image_rect_raw", "Image_"),
        ("%camera%depth%camera_info", "CameraInfo_"),
        ("%tf_static", "TFMessage_"),
    }
    process.process.terminate()
    assert process.end() == 0
    driver.tokens_when(lambda all_of: not all_of)
