"""Recordings of ROS messages are replayed as a live camera is: bags of both kinds and MCAP files."""

from contextlib import closing, suppress
from itertools import pairwise

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import SourceEnded
from cliffscan.services.capture.sources.open_source import open_source

SECOND = 1_000_000_000  # [ns]
START = 100 * SECOND
DEPTHS = [np.full((2, 3), value, np.uint16) for value in (500, 600, 700)]
TOPIC, INFO = "/camera/depth/image_rect_raw", "/camera/depth/camera_info"
KINDS = ["bag", "sqlite", "mcap folder", "db3 file", "mcap file"]


def header(store, stamp, frame, ros1):
    time = store.types["builtin_interfaces/msg/Time"](stamp // SECOND, stamp % SECOND)
    kind = store.types["std_msgs/msg/Header"]
    return kind(0, time, frame) if ros1 else kind(time, frame)


def messages(store, ros1, topic):
    """Each message with its topic, type and stamp."""
    types = store.types
    point, turn = types["geometry_msgs/msg/Vector3"](0.1, 0.0, 0.7), types["geometry_msgs/msg/Quaternion"]
    moved = types["geometry_msgs/msg/Transform"](point, turn(-0.5, 0.5, -0.5, 0.5))
    joint = types["geometry_msgs/msg/TransformStamped"](header(store, START, "base_link", ros1), "eye", moved)
    yield "/tf_static", "tf2_msgs/msg/TFMessage", START, types["tf2_msgs/msg/TFMessage"]([joint])
    k, p = np.array([3.0, 0, 1, 0, 2.5, 0.5, 0, 0, 1]), np.zeros(12)
    for number, depth in enumerate(DEPTHS):
        stamp = START + number * SECOND // 10
        head = header(store, stamp, "eye", ros1)
        image = types["sensor_msgs/msg/Image"](head, 2, 3, "16UC1", 0, 6, depth.view(np.uint8).ravel())
        yield topic, "sensor_msgs/msg/Image", stamp, image
        region = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
        info = types["sensor_msgs/msg/CameraInfo"](head, 2, 3, "", np.zeros(5), k, np.eye(3).ravel(), p, 0, 0, region)
        yield f"{topic.rpartition('/')[0]}/camera_info", "sensor_msgs/msg/CameraInfo", stamp, info


def record(folder, kind, topics=(TOPIC,)):
    """A recording of depth topics, and its path."""
    ros1 = kind == "bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    if ros1:
        definition = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(definition, "tf2_msgs/msg/TFMessage"))
        path = folder / "drive.bag"
        writer = Writer1(path)
    else:
        path = folder / "drive"
        plugin = StoragePlugin.MCAP if "mcap" in kind else StoragePlugin.SQLITE3
        writer = Writer2(path, version=9, storage_plugin=plugin)
    with writer:
        connections = {}
        for topic in topics:
            for name, kind_of, stamp, message in messages(store, ros1, topic):
                if name not in connections:
                    connections[name] = writer.add_connection(name, kind_of, typestore=store)
                raw = store.serialize_ros1(message, kind_of) if ros1 else store.serialize_cdr(message, kind_of)
                writer.write(connections[name], stamp, raw)
    return next(path.glob(f"*.{kind.split()[0]}")) if kind.endswith("file") else path


def opened(path, **settings):
    return open_source(CaptureConfig(source="replay", path=str(path), rate=1000, **settings))


def frames(source):
    """All frames until the end."""
    found = []
    with closing(source), suppress(SourceEnded):
        while True:
            frame = source.read(1.0)
            found += [frame] if frame else []
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_is_played_with_its_stamps_camera_and_mount(tmp_path, kind):
    played = frames(opened(record(tmp_path, kind), loop=False))
    assert [frame.depth.tolist() for frame in played] == [depth.tolist() for depth in DEPTHS]
    assert [frame.stamp for frame in played] == [START + number * SECOND // 10 for number in range(3)]
    for frame in played:
        assert frame.camera.intrinsics == (3.0, 2.5, 1.0, 0.5)
        assert frame.camera.floor == pytest.approx((0.0, -1.0, 0.0, 0.7))
        assert frame.place == pytest.approx((0.1, 0.0, 0.0))


def test_a_further_round_goes_on_from_the_last_stamp(tmp_path):
    source = opened(record(tmp_path, "bag"), loop=True)
    stamps = []
    while len(stamps) < 7:
        frame = source.read(1.0)
        stamps += [frame.stamp] if frame else []
    source.close()
    assert all(after > before for before, after in pairwise(stamps))


def test_of_several_depth_topics_one_is_named(tmp_path):
    path = record(tmp_path, "bag", [TOPIC, "/rear/depth/image"])
    with pytest.raises(ConfigError, match=f"2 depth topics: set capture.topic to one of {TOPIC}, /rear/depth/image"):
        opened(path)
    assert len(frames(opened(path, topic="/rear/depth/image", loop=False))) == 3
    with pytest.raises(ConfigError, match=r"no depth topic /front: set capture\.topic to one of"):
        opened(path, topic="/front")


@pytest.mark.parametrize("name", ["drive.bag", "drive.mcap", "drive.db3", "drive.txt"])
def test_a_file_that_is_no_recording_is_refused_in_one_line(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(ConfigError, match="give a ROS bag, an MCAP file or a depth folder") as refused:
        opened(path)
    assert "\n" not in str(refused.value)
