"""`cliffscan up` with `ros2` beside it: a foreign ROS node finds the robot, watches it, and drives it to the stairs."""

import sys

import pytest
import zenoh_ros2_sdk

from tests.service.conftest import free_endpoint, repeated
from tests.service.test_ros2 import twist
from tests.service.test_ros2_peers import DEADLINE, definition, heard_by_sdk, publishers, sdk  # noqa: F401 - a fixture

EDGE, RADIUS = 3.0, 0.1775  # [m] where the stairs of `landing` begin, and the robot's disc
SPEED = 0.4  # [m/s]
STANDING = 25  # messages of odometry, half a second


@pytest.mark.slow
def test_a_ros_node_drives_the_robot_which_stops_at_the_stairs(client, run, start, sdk):  # noqa: F811
    ends = ["--listen", free_endpoint(), "--connect", client.endpoint]
    run(
        [
            sys.executable,
            "-m",
            "cliffscan",
            "up",
            "--robot",
            client.robot,
            "--world",
            "landing",
            "--set",
            "capture.rate=10",
            *ends,
        ]
    )
    start("ros2")
    for service in ("capture", "negative", "positive", "fuse", "kobuki"):
        client.wait_alive(service)
    assert all(publishers(sdk, topic)[0].node_name == "cliffscan" for topic in ("/scan", "/odom", "/tf"))
    odometry = heard_by_sdk(sdk, "/odom", "nav_msgs/msg/Odometry")
    scans = heard_by_sdk(sdk, "/scan", "sensor_msgs/msg/LaserScan")
    transforms = heard_by_sdk(sdk, "/tf", "tf2_msgs/msg/TFMessage")
    diagnostics = heard_by_sdk(sdk, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    states = client.listen("base/state")
    with driving(sdk):
        standing = 0
        while standing < STANDING:
            told = odometry.get(timeout=DEADLINE)
            at_stairs = told.pose.pose.position.x > 1.0 and abs(told.twist.twist.linear.x) < 0.01
            standing = standing + 1 if at_stairs else 0
        while not any(each.name == "cliffscan: gate" and "obstacle" in values(each) for each in status(diagnostics)):
            pass
    assert 2.0 < told.pose.pose.position.x < EDGE - RADIUS
    assert scans.get(timeout=DEADLINE).header.frame_id == "camera_scan"
    assert transforms.get(timeout=DEADLINE).transforms[0].child_frame_id == "base_link"
    assert not any(any(each["wheel_drops"]) or any(each["cliffs"]) for each in states.all())


def driving(where):
    """Publish /cmd_vel, straight ahead, ten times a second meanwhile."""
    publisher = zenoh_ros2_sdk.ROS2Publisher(topic="/cmd_vel", **definition("geometry_msgs/msg/Twist"), **where)
    ahead = twist(SPEED, 0.0)
    return repeated(lambda: publisher.publish(linear=ahead.linear, angular=ahead.angular), 0.1)


def status(diagnostics):
    return diagnostics.get(timeout=DEADLINE).status


def values(status_of):
    return {each.value for each in status_of.values}
