"""The definitions of the ROS messages that viewers are sent. Source: common_interfaces and tf2_msgs, of Jazzy."""

from functools import cache

SEPARATOR = "=" * 80

DEFINITIONS: dict[str, tuple[str, ...]] = {
    "builtin_interfaces/msg/Time": (
        "int32 sec",
        "uint32 nanosec",
    ),
    "geometry_msgs/msg/Point": (
        "float64 x",
        "float64 y",
        "float64 z",
    ),
    "geometry_msgs/msg/Pose": (
        "geometry_msgs/Point position",
        "geometry_msgs/Quaternion orientation",
    ),
    "geometry_msgs/msg/PoseWithCovariance": (
        "geometry_msgs/Pose pose",
        "float64[36] covariance",
    ),
    "geometry_msgs/msg/Quaternion": (
        "float64 x",
        "float64 y",
        "float64 z",
        "float64 w",
    ),
    "geometry_msgs/msg/Transform": (
        "geometry_msgs/Vector3 translation",
        "geometry_msgs/Quaternion rotation",
    ),
    "geometry_msgs/msg/TransformStamped": (
        "std_msgs/Header header",
        "string child_frame_id",
        "geometry_msgs/Transform transform",
    ),
    "geometry_msgs/msg/Twist": (
        "geometry_msgs/Vector3 linear",
        "geometry_msgs/Vector3 angular",
    ),
    "geometry_msgs/msg/TwistWithCovariance": (
        "geometry_msgs/Twist twist",
        "float64[36] covariance",
    ),
    "geometry_msgs/msg/Vector3": (
        "float64 x",
        "float64 y",
        "float64 z",
    ),
    "nav_msgs/msg/MapMetaData": (
        "builtin_interfaces/Time map_load_time",
        "float32 resolution",
        "uint32 width",
        "uint32 height",
        "geometry_msgs/Pose origin",
    ),
    "nav_msgs/msg/OccupancyGrid": (
        "std_msgs/Header header",
        "nav_msgs/MapMetaData info",
        "int8[] data",
    ),
    "nav_msgs/msg/Odometry": (
        "std_msgs/Header header",
        "string child_frame_id",
        "geometry_msgs/PoseWithCovariance pose",
        "geometry_msgs/TwistWithCovariance twist",
    ),
    "sensor_msgs/msg/CameraInfo": (
        "std_msgs/Header header",
        "uint32 height",
        "uint32 width",
        "string distortion_model",
        "float64[] d",
        "float64[9] k",
        "float64[9] r",
        "float64[12] p",
        "uint32 binning_x",
        "uint32 binning_y",
        "sensor_msgs/RegionOfInterest roi",
    ),
    "sensor_msgs/msg/Image": (
        "std_msgs/Header header",
        "uint32 height",
        "uint32 width",
        "string encoding",
        "uint8 is_bigendian",
        "uint32 step",
        "uint8[] data",
    ),
    "sensor_msgs/msg/LaserScan": (
        "std_msgs/Header header",
        "float32 angle_min",
        "float32 angle_max",
        "float32 angle_increment",
        "float32 time_increment",
        "float32 scan_time",
        "float32 range_min",
        "float32 range_max",
        "float32[] ranges",
        "float32[] intensities",
    ),
    "sensor_msgs/msg/PointCloud2": (
        "std_msgs/Header header",
        "uint32 height",
        "uint32 width",
        "sensor_msgs/PointField[] fields",
        "bool is_bigendian",
        "uint32 point_step",
        "uint32 row_step",
        "uint8[] data",
        "bool is_dense",
    ),
    "sensor_msgs/msg/PointField": (
        "uint8 INT8=1",
        "uint8 UINT8=2",
        "uint8 INT16=3",
        "uint8 UINT16=4",
        "uint8 INT32=5",
        "uint8 UINT32=6",
        "uint8 FLOAT32=7",
        "uint8 FLOAT64=8",
        "string name",
        "uint32 offset",
        "uint8 datatype",
        "uint32 count",
    ),
    "sensor_msgs/msg/RegionOfInterest": (
        "uint32 x_offset",
        "uint32 y_offset",
        "uint32 height",
        "uint32 width",
        "bool do_rectify",
    ),
    "std_msgs/msg/Header": (
        "builtin_interfaces/Time stamp",
        "string frame_id",
    ),
    "tf2_msgs/msg/TFMessage": ("geometry_msgs/TransformStamped[] transforms",),
}


@cache
def schema(name: str) -> str:
    """A message's definition, followed by those of all that it is made of, as `ros2msg` has them."""
    parts = ["\n".join(DEFINITIONS[name])]
    parts += [f"MSG: {part.replace('/msg/', '/')}\n" + "\n".join(DEFINITIONS[part]) for part in _parts(name)]
    return f"\n{SEPARATOR}\n".join(parts)


def _parts(name: str) -> list[str]:
    """The messages that a message is made of, each once."""
    found: dict[str, None] = {}
    for line in DEFINITIONS[name]:
        kind = line.split("[")[0].split()[0].replace("/", "/msg/")
        if kind in DEFINITIONS:
            found |= dict.fromkeys([kind, *_parts(kind)])
    return list(found)
