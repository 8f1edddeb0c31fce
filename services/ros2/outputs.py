"""What the robot publishes in ROS: for each of its topics, the ROS topics that are made of it."""

from collections.abc import Callable
from typing import Any

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry, SafetyState, Velocity
from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.messages import DepthImage, LaserScan, ServiceStatus
from cliffscan.common.perception.known_ground import known_ground
from cliffscan.services.ros2 import diagnostics, interfaces, messages, scans, transforms
from cliffscan.services.ros2.config import Ros2Config
from cliffscan.services.ros2.feed import Feed, Output
from cliffscan.services.ros2.map_frame import MapFrame
from cliffscan.services.ros2.node import Profile
from cliffscan.services.ros2.ports import Node, Service
from cliffscan.services.ros2.robot_model import RobotModel
from cliffscan.services.ros2.scans import KnownScan

BATTERY_RATE = 1.0  # [Hz] of the battery's state, of which the base has 50
NEWEST = 2  # depth images that may wait: one is converted meanwhile

Maker = Callable[[Service[Ros2Config], Node], Feed[Any]]


def feeds(service: Service[Ros2Config], node: Node) -> list[Feed[Any]]:
    """All topics of the robot that something in ROS is made of, for a base of ours or one that ROS drives."""
    makers: list[Maker] = [map_of_slam, statuses, safety, *([depth] if service.config.camera == "cliffscan" else [])]
    if service.config.base == "external":
        return [Scanner(service, node).feed, *(make(service, node) for make in (*makers, safe_commands))]
    made = [make(service, node) for make in (*makers, gyro, battery)]
    return [Scanner(service, node).feed, *odometry_and_pose(service, node), *made]


class Scanner:
    """The scans. A scanner has one grid for ever."""

    def __init__(self, service: Service[Ros2Config], node: Node) -> None:
        model = RobotModel(service, node)
        self._service = service
        self._config = service.config
        self._grid: Grid | None = None
        slam_range = self._config.slam_range
        ranges: dict[str, Callable[[KnownScan], Ranges]] = {
            "scan": lambda known: scans.for_slam(*known, slam_range),
            "scan_marks": lambda known: scans.for_marking(known.scan, slam_range),
            "scan_clear": lambda known: scans.for_clearing(*known, slam_range, model.nearest_floor),
        }
        outputs = [
            Output(node.publisher(topic, interfaces.LASER_SCAN, Profile.SENSOR_DATA), self._message(choose))
            for topic, choose in ranges.items()
        ]
        cloud = node.publisher("cliff_points", interfaces.POINT_CLOUD, Profile.SENSOR_DATA)
        outputs.append(Output(cloud, lambda known: messages.point_cloud(known.scan, transforms.SCAN_FRAME)))
        self.feed = Feed(service, topics.SCAN_FUSED, outputs, self._accept)

    def _message(self, choose: Callable[[KnownScan], Ranges]) -> Callable[[KnownScan], bytes]:
        range_max = scans.range_max(self._config.slam_range)
        return lambda known: messages.laser_scan(known.scan, choose(known), transforms.SCAN_FRAME, range_max)

    def _accept(self, scan: LaserScan) -> None:
        grid = scan.grid()
        self._grid = self._grid or grid
        if not self._grid.matches(grid):
            why = f"a scan has {grid}, the first one had {self._grid}: restart ros2 and the SLAM after such a change"
            self._service.metrics.warn_limited("mismatch", why)
            return
        self.feed.publish(KnownScan(scan, known_ground(scan)))
        self._service.metrics.output(scan.stamp)


def odometry_and_pose(service: Service[Ros2Config], node: Node) -> list[Feed[Any]]:
    """/odom, and /tf from the map, where a SLAM publishes a pose on it, to odom and to the base."""
    frame = service.config.base_frame
    odom = node.publisher("odom", interfaces.ODOMETRY, Profile.DEFAULT)
    tf = node.publisher("tf", interfaces.TF_MESSAGE, Profile.DEFAULT)
    outputs = [
        Output[Odometry](odom, lambda message: messages.odometry(message, frame)),
        Output[Odometry](tf, lambda message: messages.tf_message([transforms.of_odometry(message, frame)])),
    ]
    map_frame = MapFrame()

    def accept(message: Odometry) -> None:
        map_frame.moved(message)
        moving.publish(message)

    def place(pose: Pose2D) -> bytes | None:
        transform = map_frame.transform(pose)
        return messages.tf_message([transform]) if transform else None

    moving = Feed(service, topics.ODOMETRY, outputs, accept)
    return [moving, Feed(service, topics.POSE, [Output(tf, place)])]


def gyro(service: Service[Ros2Config], node: Node) -> Feed[Imu]:
    """/imu/data, in the base's frame: all points of a rigid body turn alike."""
    frame = service.config.base_frame
    publisher = node.publisher("imu/data", interfaces.IMU, Profile.SENSOR_DATA)
    return Feed(service, topics.IMU, [Output[Imu](publisher, lambda message: messages.imu(message, frame))])


def battery(service: Service[Ros2Config], node: Node) -> Feed[BaseState]:
    """/battery_state."""
    frame = service.config.base_frame
    publisher = node.publisher("battery_state", interfaces.BATTERY_STATE, Profile.DEFAULT)
    output = Output[BaseState](publisher, lambda state: messages.battery_state(state, frame))
    return Feed(service, topics.BASE_STATE, [output], room=1, rate=BATTERY_RATE)


def safe_commands(service: Service[Ros2Config], node: Node) -> Feed[Velocity]:
    """/cmd_vel_safe, as Twist and as TwistStamped."""
    frame = service.config.base_frame
    plain = node.publisher("cmd_vel_safe", interfaces.TWIST, Profile.DEFAULT)
    stamped = node.publisher("cmd_vel_safe", interfaces.TWIST_STAMPED, Profile.DEFAULT)
    outputs = [
        Output[Velocity](plain, lambda each: messages.twist(each.linear, each.angular)),
        Output[Velocity](stamped, lambda each: messages.twist_stamped(each.stamp, frame, each.linear, each.angular)),
    ]
    return Feed(service, topics.VELOCITY_SAFE, outputs)


def statuses(service: Service[Ros2Config], node: Node) -> Feed[ServiceStatus]:
    """/diagnostics of every service."""
    robot = service.bus.robot
    publisher = node.publisher("diagnostics", interfaces.DIAGNOSTIC_ARRAY, Profile.DEFAULT)
    output = Output[ServiceStatus](publisher, lambda status: diagnostics.of_status(status, robot))
    return Feed(service, topics.STATUS.named("*"), [output])


def safety(service: Service[Ros2Config], node: Node) -> Feed[SafetyState]:
    """/diagnostics of the gate."""
    robot = service.bus.robot
    publisher = node.publisher("diagnostics", interfaces.DIAGNOSTIC_ARRAY, Profile.DEFAULT)
    return Feed(
        service, topics.SAFETY, [Output[SafetyState](publisher, lambda state: diagnostics.of_safety(state, robot))]
    )


def map_of_slam(service: Service[Ros2Config], node: Node) -> Feed[OccupancyGrid]:
    """/map, the last one kept for whoever subscribes later."""
    publisher = node.publisher("map", interfaces.OCCUPANCY_GRID, Profile.LATCHED)
    return Feed(service, topics.MAP, [Output(publisher, messages.occupancy_grid)])


def depth(service: Service[Ros2Config], node: Node) -> Feed[DepthImage]:
    """/camera/depth: image and camera_info."""
    image = node.publisher("camera/depth/image_rect_raw", interfaces.IMAGE, Profile.SENSOR_DATA)
    info = node.publisher("camera/depth/camera_info", interfaces.CAMERA_INFO, Profile.SENSOR_DATA)
    outputs = [Output(image, messages.image), Output(info, messages.camera_info)]
    return Feed(service, topics.DEPTH, outputs, room=NEWEST)
