"""Each ROS message, read by an independent CDR library that knows the definitions."""

import math

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry
from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.map_messages import OccupancyGrid
from cliffscan.common.contract.messages import DepthImage, ServiceStatus
from cliffscan.services.ros2 import diagnostics, messages
from cliffscan.services.ros2.cdr import CdrError
from cliffscan.services.ros2.transforms import Transform
from tests.build import scan, status_fields

ROS = get_typestore(Stores.ROS2_JAZZY)
STAMP = 1_700_000_000_123_456_789
SCAN = scan([1.0, math.inf, math.nan, 2.5], [2, 0, 0, 1], stamp=STAMP)


def read(payload, name):
    """The message in our bytes, which the library writes to the very same."""
    message = ROS.deserialize_cdr(payload, name)
    assert bytes(ROS.serialize_cdr(message, name)) == payload
    return message


def nanoseconds(stamp):
    return stamp.sec * 1_000_000_000 + stamp.nanosec


@pytest.mark.parametrize("frame", ["", "a", "ab", "abc", "camera_scan"])
def test_laser_scan(frame):
    ranges = np.array([1.0, np.nan, 4.49, 2.5], "f4")
    message = read(messages.laser_scan(SCAN, ranges, frame, 4.5), "sensor_msgs/msg/LaserScan")
    assert (message.header.frame_id, nanoseconds(message.header.stamp)) == (frame, STAMP)
    assert (message.angle_min, message.range_max) == (-0.5, 4.5)
    assert round((message.angle_max - message.angle_min) / message.angle_increment) + 1 == 4
    np.testing.assert_array_equal(message.ranges, ranges)
    np.testing.assert_array_equal(message.intensities, [2, 0, 0, 1])


def test_every_grid_has_the_number_of_beams_that_slam_toolbox_computes():
    for beams in (2, 3, 80, 639, 640, 641, 1280, 5000):
        made = scan(np.ones(beams), angle_min=-math.radians(29))
        message = read(messages.laser_scan(made, made.ranges, "f", 4.5), "sensor_msgs/msg/LaserScan")
        span = np.float32(message.angle_max) - np.float32(message.angle_min)
        assert round(float(span / np.float32(message.angle_increment))) + 1 == beams


def test_point_cloud_has_the_numbers_and_their_evidence():
    message = read(messages.point_cloud(SCAN, "camera_scan"), "sensor_msgs/msg/PointCloud2")
    assert [(each.name, each.offset, each.datatype) for each in message.fields] == [
        ("x", 0, 7),
        ("y", 4, 7),
        ("z", 8, 7),
        ("intensity", 12, 7),
    ]
    assert (message.height, message.width, message.row_step) == (1, 2, 32)
    expected = [[math.cos(0.5), -math.sin(0.5), 0, 2], [2.5 * math.cos(0.5), 2.5 * math.sin(0.5), 0, 1]]
    np.testing.assert_allclose(message.data.view("<f4").reshape(2, 4), expected, rtol=1e-6)


def test_a_cloud_may_be_empty():
    message = read(messages.point_cloud(scan([math.inf, math.nan]), "f"), "sensor_msgs/msg/PointCloud2")
    assert (message.width, len(message.data)) == (0, 0)


ODOMETRY = Odometry(
    stamp=STAMP,
    frame="odom",
    child_frame="base_link",
    pose=(1.0, 2.0, math.pi / 2),
    twist=(0.3, -0.4),
    pose_covariance=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
    twist_covariance=[0.1] * 9,
)


def test_odometry():
    message = read(messages.odometry(ODOMETRY, "base_footprint"), "nav_msgs/msg/Odometry")
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_footprint")
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    assert (place.x, place.y, place.z) == (1.0, 2.0, 0.0)
    assert (turn.z, turn.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    assert (message.twist.twist.linear.x, message.twist.twist.angular.z) == (0.3, -0.4)
    covariance = message.pose.covariance.reshape(6, 6)
    np.testing.assert_array_equal(covariance[np.ix_((0, 1, 5), (0, 1, 5))].ravel(), ODOMETRY.pose_covariance)
    assert covariance[2, 2] == covariance[3, 3] == covariance[4, 4] == messages.NOT_MEASURED


def test_a_stamp_after_2038_is_refused():
    last = 2**31 * 1_000_000_000 - 1
    message = read(messages.odometry(ODOMETRY.model_copy(update={"stamp": last}), "b"), "nav_msgs/msg/Odometry")
    assert nanoseconds(message.header.stamp) == last
    with pytest.raises(CdrError, match="2038"):
        messages.odometry(ODOMETRY.model_copy(update={"stamp": last + 1}), "b")


def test_tf_message():
    made = Transform(STAMP, "odom", "base_link", (1.0, 2.0, 0.0), (0.0, 0.0, 0.6, 0.8))
    message = read(messages.tf_message([made, made._replace(child="b")]), "tf2_msgs/msg/TFMessage")
    assert [each.child_frame_id for each in message.transforms] == ["base_link", "b"]
    first = message.transforms[0]
    assert (first.header.frame_id, first.transform.translation.y, first.transform.rotation.w) == ("odom", 2.0, 0.8)


@pytest.mark.parametrize(("samples", "rate"), [([], 0.5), ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 6.0)])
def test_imu_has_the_newest_rate_and_no_acceleration(samples, rate):
    made = Imu(
        stamp=STAMP,
        frame="gyro_link",
        heading=math.pi,
        heading_rate=0.5,
        sample_stamps=[STAMP] * (len(samples) // 3),
        angular_velocities=np.array(samples, "f4"),
    )
    message = read(messages.imu(made, "base_link"), "sensor_msgs/msg/Imu")
    assert (message.orientation.z, message.angular_velocity.z) == (1.0, rate)
    assert message.linear_acceleration_covariance[0] == -1.0
    assert message.orientation_covariance[8] < message.orientation_covariance[0]


@pytest.mark.parametrize(("charger", "status"), [("discharging", 2), ("dock_charging", 1), ("unknown", 0)])
def test_battery_state(charger, status):
    made = BaseState(
        stamp=STAMP,
        bumpers=(False,) * 3,
        cliffs=(False,) * 3,
        cliff_counts=(0, 0, 0),
        wheel_drops=(False,) * 2,
        overcurrents=(False,) * 2,
        currents=(0.0, 0.0),
        buttons=(False,) * 3,
        battery_voltage=16.0,
        battery_percent=75.0,
        charger=charger,
        dock_ir=(0, 0, 0),
        digital_inputs=(False,) * 4,
        analog_inputs=(0.0,) * 4,
    )
    message = read(messages.battery_state(made, "base_link"), "sensor_msgs/msg/BatteryState")
    assert (message.voltage, message.percentage, message.power_supply_status) == (16.0, 0.75, status)
    assert message.present
    assert math.isnan(message.current)


@pytest.mark.parametrize(
    ("state", "note", "level"), [("working", "", 0), ("working", "slow", 1), ("starting", "", 1), ("waiting", "x", 2)]
)
def test_a_status_is_a_diagnostic(state, note, level):
    made = ServiceStatus.of(status_fields(state=state, note=note) | {"latency": (0.004, 0.009)})
    message = read(diagnostics.of_status(made, "turtlebot"), "diagnostic_msgs/msg/DiagnosticArray")
    (status,) = message.status
    assert (status.level, status.name, status.hardware_id) == (level, "cliffscan: fuse", "turtlebot")
    assert status.message == (note or state)
    assert {each.key: each.value for each in status.values}["latency p99 [ms]"] == "9.0"


@pytest.mark.parametrize(
    ("rule", "latched", "level"),
    [("free", False, 0), ("obstacle", False, 0), ("no_scan", False, 1), ("stopped", True, 2)],
)
def test_the_gate_is_a_diagnostic(rule, latched, level):
    made = diagnostics.SafetyState(
        stamp=STAMP, rule=rule, distance=-1.0, asked=(0.2, 0.0), allowed=(0.0, 0.0), latched=latched, note=""
    )
    (status,) = read(diagnostics.of_safety(made, "r"), "diagnostic_msgs/msg/DiagnosticArray").status
    assert (status.level, status.name, status.message) == (level, "cliffscan: gate", rule)


def test_occupancy_grid():
    cells = np.array([-1, 0, 100, 50, 0, -1], "i1")
    made = OccupancyGrid(
        stamp=STAMP, frame="map", resolution=0.05, width=3, height=2, origin=(1.0, -2.0, math.pi), data=cells
    )
    message = read(messages.occupancy_grid(made), "nav_msgs/msg/OccupancyGrid")
    assert (message.info.width, message.info.height, message.info.origin.position.y) == (3, 2, -2.0)
    assert message.info.resolution == pytest.approx(0.05)
    np.testing.assert_array_equal(message.data, cells)


def depth_image():
    camera = Camera(3, 2, Intrinsics(3.0, 2.5, 1.0, 0.5), (0.5, 4.5), FloorPlane(0.0, -1.0, 0.0, 0.3))
    depth = np.array([[0, 500, 1000], [1500, 2000, 65535]], np.uint16)
    return DepthImage.pack(1, STAMP, "eye", depth, camera, "16UC1"), depth


def test_image():
    made, depth = depth_image()
    message = read(messages.image(made), "sensor_msgs/msg/Image")
    assert (message.header.frame_id, message.encoding, message.step) == ("eye", "16UC1", 6)
    np.testing.assert_array_equal(message.data.view("<u2").reshape(2, 3), depth)


def test_camera_info():
    message = read(messages.camera_info(depth_image()[0]), "sensor_msgs/msg/CameraInfo")
    assert (message.width, message.height, message.distortion_model) == (3, 2, "plumb_bob")
    expected = [[3.0, 0, 1.0], [0, 2.5, 0.5], [0, 0, 1.0]]
    np.testing.assert_array_equal(message.k.reshape(3, 3), expected)
    np.testing.assert_array_equal(message.p.reshape(3, 4)[:, :3], expected)
    np.testing.assert_array_equal(message.r.reshape(3, 3), np.eye(3))


def test_twists():
    message = read(messages.twist(0.2, -0.5), "geometry_msgs/msg/Twist")
    assert (message.linear.x, message.angular.z) == (0.2, -0.5)
    stamped = read(messages.twist_stamped(STAMP, "base_link", 0.2, -0.5), "geometry_msgs/msg/TwistStamped")
    assert (stamped.twist.linear.x, stamped.twist.angular.z) == (0.2, -0.5)
    assert nanoseconds(stamped.header.stamp) == STAMP
