"""Recordings of a depth camera by others' writers: rosbags' of both ROS, and the MCAP project's own."""

import numpy as np
from mcap.reader import make_reader
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SECOND = 1_000_000_000  # [ns]
START = 100 * SECOND
TOPIC, INFO = "/camera/depth/image_rect_raw", "/camera/depth/camera_info"
KINDS = ["bag", "sqlite", "mcap folder", "db3 file", "mcap file", "mcap of its project"]
INTRINSICS = (3.0, 2.5, 1.0, 0.5)
DEPTHS = [np.full((2, 3), value, np.uint16) for value in (500, 600, 700)]
CUT = 30  # [bytes] that are left of a damaged message


def stamp_of(number):
    return START + number * SECOND // 10


def header(store, stamp, frame, ros1):
    time = store.types["builtin_interfaces/msg/Time"](stamp // SECOND, stamp % SECOND)
    kind = store.types["std_msgs/msg/Header"]
    return kind(0, time, frame) if ros1 else kind(time, frame)


def messages(store, ros1, topic, depths, intrinsics, height):
    """Each message with its topic, type and stamp: a level camera `height` [m] above the floor, 10 cm ahead."""
    types = store.types
    point, turn = types["geometry_msgs/msg/Vector3"](0.1, 0.0, height), types["geometry_msgs/msg/Quaternion"]
    moved = types["geometry_msgs/msg/Transform"](point, turn(-0.5, 0.5, -0.5, 0.5))
    joint = types["geometry_msgs/msg/TransformStamped"](header(store, START, "base_link", ros1), "eye", moved)
    if height:
        yield "/tf_static", "tf2_msgs/msg/TFMessage", START, types["tf2_msgs/msg/TFMessage"]([joint])
    fx, fy, cx, cy = intrinsics
    k, p = np.array([fx, 0, cx, 0, fy, cy, 0, 0, 1]), np.zeros(12)
    for number, depth in enumerate(depths):
        stamp, (rows, columns) = stamp_of(number), depth.shape
        head = header(store, stamp, "eye", ros1)
        image = types["sensor_msgs/msg/Image"](
            head, rows, columns, "16UC1", 0, 2 * columns, depth.view(np.uint8).ravel()
        )
        yield topic, "sensor_msgs/msg/Image", stamp, image
        region = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        info = types["sensor_msgs/msg/CameraInfo"](
            head, rows, columns, "", np.zeros(5), k, np.eye(3).ravel(), p, 0, 0, region
        )
        yield f"{topic.rpartition('/')[0]}/camera_info", "sensor_msgs/msg/CameraInfo", stamp, info


def record(folder, kind, depths=DEPTHS, intrinsics=INTRINSICS, height=0.7, topics=(TOPIC,), damaged=(), texts=()):
    """A recording of depth topics, and its path. height: 0 for no transforms; damaged: numbers of images cut short.

    texts: topics on which somebody else published a String before.
    """
    ros1 = kind == "bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    if ros1:
        definition = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(definition, "tf2_msgs/msg/TFMessage"))
    text = store.types["std_msgs/msg/String"]("nothing of the kind")
    raw = bytes((store.serialize_ros1 if ros1 else store.serialize_cdr)(text, text.__msgtype__))
    written = [(topic, text.__msgtype__, START, raw) for topic in texts]
    for topic in topics:
        for name, kind_of, stamp, message in messages(store, ros1, topic, depths, intrinsics, height):
            raw = bytes(store.serialize_ros1(message, kind_of) if ros1 else store.serialize_cdr(message, kind_of))
            cut = kind_of.endswith("/Image") and any(stamp == stamp_of(number) for number in damaged)
            written.append((name, kind_of, stamp, raw[:CUT] if cut else raw))
    if kind == "mcap of its project":
        return by_mcap(folder / "drive.mcap", store, written)
    path = folder / ("drive.bag" if ros1 else "drive")
    plugin = StoragePlugin.MCAP if "mcap" in kind else StoragePlugin.SQLITE3
    with Writer1(path) if ros1 else Writer2(path, version=9, storage_plugin=plugin) as writer:
        connections = {}
        for name, kind_of, stamp, raw in written:
            if (name, kind_of) not in connections:
                connections[name, kind_of] = writer.add_connection(name, kind_of, typestore=store)
            writer.write(connections[name, kind_of], stamp, raw)
    return next(path.glob(f"*.{kind.split()[0]}")) if kind.endswith("file") else path


def by_mcap(path, store, written):
    """The messages as the MCAP project's library writes them, each in a compressed chunk with a check sum."""
    with path.open("wb") as file:
        writer = McapWriter(file, chunk_size=1)
        writer.start(profile="ros2", library="test")
        channels = {}
        for name, kind_of, stamp, raw in written:
            if (name, kind_of) not in channels:
                definition, _ = store.generate_msgdef(kind_of, ros_version=2)
                schema = writer.register_schema(kind_of, "ros2msg", definition.encode())
                channels[name, kind_of] = writer.register_channel(name, "cdr", schema)
            writer.add_message(channels[name, kind_of], log_time=stamp, publish_time=stamp, data=raw)
        writer.finish()
    return path


def break_chunk(path, number):
    """Damage the last byte of a chunk of an MCAP file; -1 is its last one."""
    with path.open("rb") as file:
        chunk = make_reader(file).get_summary().chunk_indexes[number]
    content = bytearray(path.read_bytes())
    content[chunk.chunk_start_offset + chunk.chunk_length - 1] ^= 255
    path.write_bytes(content)
