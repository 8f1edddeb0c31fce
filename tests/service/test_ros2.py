"""The robot in ROS 2, seen by a peer that knows rmw_zenoh's wire and nothing of cliffscan."""

import math
import queue
import struct
import threading
import time

import msgpack
import numpy as np
import pytest
import xxhash
import zenoh

from cliffscan.services.ros2 import interfaces
from tests.build import depth_fields, status_fields
from tests.ros2_peer import ROS, Peer
from tests.service.conftest import DEADLINE, scan

SCAN, CLOUD = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2"
TWIST, TF = "geometry_msgs/msg/Twist", "tf2_msgs/msg/TFMessage"
MATRIX = [0.0] * 9


@pytest.fixture
def peer(client):
    made = Peer(client.endpoint)
    yield made
    made.close()


@pytest.fixture
def repeat(client):
    """Publish a message of the robot again and again, as its services do, until the test ends."""
    ended, threads = threading.Event(), []

    def begin(path, message):
        def run():
            while not ended.wait(0.02):
                client.put(path, message() if callable(message) else message)

        threads.append(threading.Thread(target=run))
        threads[-1].start()

    yield begin
    ended.set()
    for thread in threads:
        thread.join()


def twist(linear, angular):
    vector = ROS.types["geometry_msgs/msg/Vector3"]
    return ROS.types[TWIST](vector(linear, 0.0, 0.0), vector(0.0, 0.0, angular))


def odometry(**changes):
    fields = {
        "stamp": time.time_ns(),
        "frame": "odom",
        "child_frame": "base_link",
        "pose": [1.0, 2.0, 0.5],
        "twist": [0.2, 0.0],
        "pose_covariance": MATRIX,
        "twist_covariance": MATRIX,
    }
    return fields | changes


def fused():
    clear = np.array([1.5, 1.2, 4.0], "<f4").tobytes()
    evidence = np.array([2.0, 1.0, 0.0], "<f4").tobytes()
    return scan([1.5, 3.0, math.inf], time.time_ns(), range_max=5.1, clear=clear, intensities=evidence)


def description():
    camera = {
        "frame": "camera_depth_optical_frame",
        "simulated": True,
        "nearest_floor": 0.72,
        "farthest": 5.0,
        "field_of_view": [-0.5, 0.5],
        "height": 0.3,
        "pitch": 0.0,
        "roll": 0.0,
    }
    return {"stamp": 7, "camera": camera}


def test_the_node_and_its_topics_are_in_the_graph(client, start, peer):
    start("ros2")
    tokens = peer.tokens_when(lambda all_of: any(token[5] == "NN" for token in all_of))
    (node,) = [token for token in tokens if token[5] == "NN"]
    zid = node[2]
    assert node == ["@ros2_lv", "0", zid, "0", "0", "NN", "%", "%", "cliffscan"]
    endpoints = [token for token in tokens if token[5] in ("MP", "MS", "SS")]
    assert all(token[2:4] == [zid, "0"] and token[6:9] == ["%", "%", "cliffscan"] for token in endpoints)
    assert len({token[4] for token in endpoints}) == len(endpoints)
    published = {token[9].replace("%", "/") for token in endpoints if token[5] == "MP"}
    assert published == {
        "/scan", "/scan_marks", "/scan_clear", "/cliff_points", "/odom", "/tf", "/tf_static", "/imu/data",
        "/battery_state", "/diagnostics", "/map", "/robot_description",
        "/camera/depth/image_rect_raw", "/camera/depth/camera_info",
    }  # fmt: skip
    assert {(token[9], token[10]) for token in endpoints if token[5] == "MS"} == {
        ("%cmd_vel", "geometry_msgs::msg::dds_::Twist_"),
        ("%cmd_vel", "geometry_msgs::msg::dds_::TwistStamped_"),
    }
    assert {(token[9], token[10]) for token in endpoints if token[5] == "SS"} == {
        ("%cliffscan%stop", "std_srvs::srv::dds_::Trigger_"),
        ("%cliffscan%clear_safety", "std_srvs::srv::dds_::Trigger_"),
    }
    latched = {token[9] for token in endpoints if token[12].startswith("1:1:1,1:")}
    assert latched == {"%map", "%tf_static", "%robot_description"}


def test_the_node_leaves_the_graph_with_its_process(client, start, peer):
    process = start("ros2")
    peer.tokens_when(lambda tokens: len(tokens) > 10)
    process.process.terminate()
    assert process.end() == 0
    peer.tokens_when(lambda tokens: not tokens)


def test_three_scans_and_a_cloud(client, start, peer, repeat):
    start("ros2")
    subscriptions = {name: peer.subscribe(name, SCAN) for name in ("scan", "scan_marks", "scan_clear")}
    cloud = peer.subscribe("cliff_points", CLOUD)
    client.put("description", description())
    repeat("scan/fused", fused)
    got = {name: each.get() for name, each in subscriptions.items()}
    nan = math.nan
    np.testing.assert_allclose(got["scan"].ranges, [1.5, nan, 4.49])
    np.testing.assert_allclose(got["scan_marks"].ranges, [1.5, 3.0, nan])
    np.testing.assert_allclose(got["scan_clear"].ranges, [1.5, 1.15, 3.95], rtol=1e-6)
    assert {(each.range_max, each.header.frame_id) for each in got.values()} == {(4.5, "camera_scan")}
    assert list(cloud.get().data.view("<f4").reshape(-1, 4)[:, 3]) == [2.0, 1.0]


def test_a_sample_has_rmw_zenohs_attachment(client, start, peer, repeat):
    start("ros2")
    subscription = peer.subscribe("odom", "nav_msgs/msg/Odometry")
    repeat("base/odom", odometry)
    before = time.time_ns()
    first, second = (struct.unpack("<qqB16s", subscription.raw()[1]) for _ in range(2))
    assert second[0] == first[0] + 1
    assert before < first[1] <= second[1] <= time.time_ns()
    (token,) = [token for token in peer.tokens_when(len) if token[5] == "MP" and token[9] == "%odom"]
    assert first[2:] == second[2:] == (16, xxhash.xxh3_128_digest("/".join(token).encode())[::-1])


def test_odometry_and_transforms_under_a_namespace_and_in_a_domain(client, start, peer, repeat):
    options = ["ros2.domain=7", "ros2.namespace=fleet/bot", "ros2.base_frame=base_footprint"]
    start("ros2", *(word for option in options for word in ("--set", option)))
    odom = peer.subscribe("fleet/bot/odom", "nav_msgs/msg/Odometry", domain=7)
    tf = peer.subscribe("fleet/bot/tf", TF, domain=7)
    repeat("base/odom", odometry)
    assert odom.get().child_frame_id == "base_footprint"
    (transform,) = tf.get().transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_footprint")
    assert (transform.transform.translation.x, transform.transform.translation.y) == (1.0, 2.0)
    tokens = peer.tokens_when(lambda all_of: any(token[5] == "NN" for token in all_of))
    assert {token[7] for token in tokens} == {"%fleet%bot"}
    assert {token[1] for token in tokens} == {"7"}


def test_a_pose_on_the_map_places_odom(client, start, peer, repeat):
    start("ros2")
    tf = peer.subscribe("tf", TF)
    stamp = time.time_ns()
    repeat("base/odom", lambda: odometry(stamp=time.time_ns()))
    repeat("pose", lambda: {"stamp": time.time_ns(), "frame": "map", "pose": [3.0, 2.0, 0.5]})
    while (transform := tf.get().transforms[0]).header.frame_id != "map":
        pass
    assert transform.header.stamp.sec >= stamp // 10**9
    assert transform.child_frame_id == "odom"
    assert transform.transform.translation.x == pytest.approx(2.0)
    assert transform.transform.translation.y == pytest.approx(0.0, abs=1e-12)
    assert transform.transform.rotation.w == 1.0


def test_a_late_joiner_gets_the_static_transforms_and_the_map(client, start, peer):
    start("ros2")
    early = [peer.subscribe("tf_static", TF, latched=True), peer.subscribe("map", "nav_msgs/msg/OccupancyGrid", True)]
    client.put("description", description())
    grid = {"stamp": 5, "frame": "map", "resolution": 0.05, "width": 2, "height": 1, "origin": [0.0, 0.0, 0.0]}
    client.put("map", grid | {"data": np.array([0, 100], "i1").tobytes()})
    for subscription in early:
        subscription.get()
    late = Peer(client.endpoint)
    try:
        frames = {each.child_frame_id: each for each in late.subscribe("tf_static", TF, True).get().transforms}
        assert frames.keys() == {"camera_footprint", "camera_scan", "camera_link", "camera_depth_optical_frame"}
        assert frames["camera_footprint"].transform.translation.x == -0.087
        assert list(late.subscribe("map", "nav_msgs/msg/OccupancyGrid", True).get().data) == [0, 100]
    finally:
        late.close()


def test_the_rest_while_it_is_subscribed(client, start, peer, repeat):
    start("ros2")
    image = peer.subscribe("camera/depth/image_rect_raw", "sensor_msgs/msg/Image")
    info = peer.subscribe("camera/depth/camera_info", "sensor_msgs/msg/CameraInfo")
    imu = peer.subscribe("imu/data", "sensor_msgs/msg/Imu")
    repeat("camera/depth", depth_fields())
    gyro = {"stamp": 5, "frame": "gyro_link", "heading": 0.5, "heading_rate": 0.1, "sample_stamps": []}
    repeat("base/imu", gyro | {"angular_velocities": b""})
    assert list(image.get().data.view("<u2")) == [0, 500, 1000, 1500, 2000, 65535]
    assert info.get().k[0] == 3.0
    assert imu.get().angular_velocity.z == 0.1


def test_diagnostics_of_services_and_gate(client, start, peer, repeat):
    start("ros2")
    heard = peer.subscribe("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    repeat("status/fuse", status_fields())
    safety = {"stamp": 5, "rule": "no_scan", "distance": -1.0, "asked": [0.2, 0.0], "allowed": [0.0, 0.0]}
    repeat("base/safety", safety | {"latched": False, "note": "no scan for 1 s"})
    named = {}
    while not {"cliffscan: fuse", "cliffscan: gate", "cliffscan: ros2"} <= named.keys():
        (status,) = heard.get().status
        named[status.name] = status
    assert (named["cliffscan: gate"].message, named["cliffscan: gate"].level) == ("no scan for 1 s", 1)
    assert {status.hardware_id for status in named.values()} == {client.robot}


def test_nothing_is_received_that_nobody_wants(client, start, peer):
    """Whether the robot's topics are subscribed, as their publishers see it."""
    start("ros2")
    publisher = client.session.declare_publisher(f"{client.robot}/camera/depth")
    changes = queue.Queue()
    publisher.declare_matching_listener(lambda status: changes.put(status.matching))
    assert not publisher.matching_status.matching
    image = peer.subscribe("camera/depth/image_rect_raw", "sensor_msgs/msg/Image")
    assert changes.get(timeout=DEADLINE) is True
    image.close()
    assert changes.get(timeout=DEADLINE) is False


def test_a_twist_drives_and_one_that_is_broken_is_counted(client, start, peer):
    driver = "ros2.commands.teleop"
    start("ros2", "--set", f"{driver}.priority=5", "--set", f"{driver}.topic=cmd_vel_teleop")
    velocities, status = client.listen("base/cmd_vel"), client.listen("status/ros2")
    peer.publish_once("cmd_vel_teleop", TWIST, twist(math.nan, 0.0))
    peer.publish_once("cmd_vel_teleop", TWIST, twist(0.2, -0.5))
    got = velocities.get()
    assert abs(got["stamp"] - time.time_ns()) < 10e9
    assert {**got, "stamp": 0} == {"stamp": 0, "linear": 0.2, "angular": -0.5, "source": "teleop", "priority": 5}
    assert status.until(lambda message: message["counts"].get("malformed"))["counts"]["malformed"] == 1


def test_a_twist_is_of_when_it_was_sent(client, start, peer):
    start("ros2")
    velocities = client.listen("base/cmd_vel")
    peer.publish_once("cmd_vel", TWIST, twist(0.1, 0.0), sent=12_000_000_034)
    assert velocities.get()["stamp"] == 12_000_000_034


def test_a_stamped_twist_keeps_its_stamp(client, start, peer):
    start("ros2")
    velocities = client.listen("base/cmd_vel")
    header = ROS.types["std_msgs/msg/Header"](ROS.types["builtin_interfaces/msg/Time"](12, 34), "base_link")
    name = "geometry_msgs/msg/TwistStamped"
    peer.publish_once("cmd_vel", name, ROS.types[name](header, twist(0.1, 0.0)))
    assert velocities.get()["stamp"] == 12_000_000_034


def test_a_base_that_ros_drives(client, start, peer, repeat):
    start("ros2", "--set", "ros2.base=external")
    tokens = peer.tokens_when(lambda all_of: any(token[5] == "NN" for token in all_of))
    assert not {"%odom", "%tf", "%imu%data"} & {token[9] for token in tokens if token[5] == "MP"}
    safe = peer.subscribe("cmd_vel_safe", TWIST)
    odom = client.listen("base/odom")
    repeat("base/cmd_vel_safe", {"stamp": time.time_ns(), "linear": 0.1, "angular": 0.0})
    assert safe.get().linear.x == 0.1
    name = "nav_msgs/msg/Odometry"
    kinds = ROS.types
    point, turn = (
        kinds["geometry_msgs/msg/Point"](1.0, 2.0, 0.0),
        kinds["geometry_msgs/msg/Quaternion"](0.0, 0.0, 1.0, 0.0),
    )
    pose = kinds["geometry_msgs/msg/PoseWithCovariance"](kinds["geometry_msgs/msg/Pose"](point, turn), np.zeros(36))
    moving = kinds["geometry_msgs/msg/TwistWithCovariance"](twist(0.2, 0.1), np.zeros(36))
    header = kinds["std_msgs/msg/Header"](kinds["builtin_interfaces/msg/Time"](12, 34), "odom")
    peer.publish_once("odom", name, kinds[name](header, "base_link", pose, moving))
    got = odom.get()
    assert (got["pose"], got["twist"]) == ([1.0, 2.0, math.pi], [0.2, 0.1])


def test_a_camera_that_ros_drives(client, start, peer):
    start("ros2", "--set", "ros2.camera=external")
    tokens = peer.tokens_when(lambda all_of: any(token[5] == "NN" for token in all_of))
    assert not [token for token in tokens if token[5] == "MP" and token[9].startswith("%camera")]
    client.put("description", description())
    frames = {each.child_frame_id for each in peer.subscribe("tf_static", TF, latched=True).get().transforms}
    assert frames == {"camera_footprint", "camera_scan"}


def test_what_ros_cannot_express_is_counted_and_dropped(client, start, peer, repeat):
    start("ros2")
    odom, status = peer.subscribe("odom", "nav_msgs/msg/Odometry"), client.listen("status/ros2")
    repeat("base/odom", lambda: odometry(stamp=2**62))
    client.put("description", description() | {"stamp": 2**62})
    assert status.until(lambda message: message["counts"].get("malformed", 0) > 1)
    repeat("base/odom", odometry)
    assert odom.get().header.stamp.sec < 2**31


def test_a_scan_with_other_beams_is_no_scan_of_this_scanner(client, start, peer, repeat):
    start("ros2")
    heard = peer.subscribe("scan", SCAN)
    repeat("scan/fused", fused)
    heard.get()
    client.put("scan/fused", msgpack.packb(scan([1.0] * 5, time.time_ns())))
    status = client.listen("status/ros2")
    assert status.until(lambda message: message["counts"].get("mismatch"))["counts"]["mismatch"] == 1
    assert {len(heard.get().ranges) for _ in range(20)} == {3}


def test_a_service_that_nobody_can_do_says_so_and_needs_its_own_name(client, start, peer):
    start("ros2")
    peer.tokens_when(lambda tokens: any(token[5] == "SS" for token in tokens))
    key = f"0/cliffscan/stop/{interfaces.TRIGGER.dds_name}/{interfaces.TRIGGER.type_hash}"
    request = {
        "payload": b"\0\1\0\0\0",
        "attachment": struct.pack("<qqB16s", 42, time.time_ns(), 16, bytes(range(16))),
        "target": zenoh.QueryTarget.ALL,
        "timeout": DEADLINE,
    }
    assert not list(peer.session.get("0/cliffscan/*/**", **request))
    (reply,) = peer.session.get(key, **request)
    assert struct.unpack("<qqB16s", reply.ok.attachment.to_bytes())[::2] == (42, 16)
    assert reply.ok.payload.to_bytes()[4] == 0
    assert b"nobody answers base/command/stop" in reply.ok.payload.to_bytes()
    assert not list(peer.session.get(key, **(request | {"attachment": b"short"})))
    status = client.listen("status/ros2")
    assert status.until(lambda message: message["counts"].get("malformed"))["counts"]["malformed"] == 1
