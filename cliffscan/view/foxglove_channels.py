"""The topics of ROS that are made of the robot's, by the names that `ros2` gives them."""

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.map_messages import Pose2D
from cliffscan.common.contract.message import Message
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import Topic
from cliffscan.common.perception.known_ground import known_ground
from cliffscan.services.ros2 import messages, scans, transforms
from cliffscan.services.ros2.config import Ros2Config
from cliffscan.services.ros2.map_frame import MapFrame

M = TypeVar("M", bound=Message)

BASE_FRAME = "base_link"
SLAM_RANGE: float = Ros2Config.model_fields["slam_range"].default  # [m]
SCAN_HEIGHT = 0.0  # [m] above the floor: a viewer draws what lies there


class Source(NamedTuple, Generic[M]):
    """One of the robot's topics, and what is made of a message: CDR, or None where nothing is."""

    topic: Topic[M]
    convert: Callable[[M], bytes | None]


class Channel(NamedTuple):
    """A topic of ROS."""

    topic: str
    schema: str
    sources: tuple[Source[Any], ...]


def channels() -> list[Channel]:
    """All of them; one viewer's are not another's, for the map's frame remembers the odometry."""
    map_frame = MapFrame()

    def moved(odometry: Odometry) -> bytes:
        map_frame.moved(odometry)
        return messages.tf_message([transforms.of_odometry(odometry, BASE_FRAME)])

    def located(pose: Pose2D) -> bytes | None:
        placed = map_frame.transform(pose)
        return messages.tf_message([placed]) if placed else None

    image = "/camera/depth/image_rect_raw"
    info = "/camera/depth/camera_info"
    scan, odom = topics.SCAN_FUSED, topics.ODOMETRY
    frame = transforms.SCAN_FRAME
    return [
        Channel(
            "/scan",
            "sensor_msgs/msg/LaserScan",
            (Source(scan, lambda each: _scan(each, scans.for_slam(each, known_ground(each), SLAM_RANGE))),),
        ),
        Channel(
            "/scan_marks",
            "sensor_msgs/msg/LaserScan",
            (Source(scan, lambda each: _scan(each, scans.for_marking(each, SLAM_RANGE))),),
        ),
        Channel(
            "/cliff_points",
            "sensor_msgs/msg/PointCloud2",
            (Source(scan, lambda each: messages.point_cloud(each, frame)),),
        ),
        Channel("/odom", "nav_msgs/msg/Odometry", (Source(odom, lambda each: messages.odometry(each, BASE_FRAME)),)),
        Channel("/tf", "tf2_msgs/msg/TFMessage", (Source(odom, moved), Source(topics.POSE, located))),
        Channel("/tf_static", "tf2_msgs/msg/TFMessage", (Source(topics.DESCRIPTION, _mount),)),
        Channel("/map", "nav_msgs/msg/OccupancyGrid", (Source(topics.MAP, messages.occupancy_grid),)),
        Channel(image, "sensor_msgs/msg/Image", (Source(topics.DEPTH, messages.image),)),
        Channel(info, "sensor_msgs/msg/CameraInfo", (Source(topics.DEPTH, messages.camera_info),)),
    ]


def _scan(scan: LaserScan, ranges: Ranges) -> bytes:
    return messages.laser_scan(scan, ranges, transforms.SCAN_FRAME, scans.range_max(SLAM_RANGE))


def _mount(description: RobotDescription) -> bytes | None:
    camera = description.camera
    if camera is None:
        return None
    return messages.tf_message(transforms.of_camera(camera, BASE_FRAME, SCAN_HEIGHT, description.stamp))
