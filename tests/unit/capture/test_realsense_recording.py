"""Files that librealsense itself recorded, of several versions: depths in any unit become millimetres."""

import struct
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Reader, Writer

from cliffscan.check_data import check_data
from cliffscan.common.contract.camera import check_camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros import realsense_wire as wire
from cliffscan.services.capture.sources import realsense_sensor
from cliffscan.services.capture.sources.depth_source import BadFrame
from cliffscan.services.capture.sources.replay import open_recorded

FILES = Path(__file__).parents[2] / "data" / "realsense"
OLD, NEW = FILES / "one_eye_2.55.bag", FILES / "two_eyes_2.58.db3"
INTRINSICS = (21.0, 20.0, 15.5, 12.0)
STAMPS = [1_700_000_000_000_000_000 + 50_000_000 * number for number in range(3)]
PIXELS = [np.add.outer(4 * np.arange(24), np.arange(32)) + 4000 + number for number in range(3)]
UNIT_TOPIC = "/device_0/sensor_0/option/Depth_Units/value"
IMAGES = "/device_0/sensor_0/Depth_0/image/data"


def config(path):
    return CaptureConfig(source="replay", path=str(path), height=0.4)


def frames(path):
    """All frames, and where their numbers come from."""
    with closing(open_recorded(config(path))) as recorded:
        assert len(recorded) == 3
        return [image.read() for image in recorded.images()], recorded.origins()


def check(path, unit, baseline):
    """The frames have what realsense_file.py recorded."""
    found, origins = frames(path)
    assert origins.units == f"{1000 * unit:g} mm as recorded, which become millimetres"
    for frame, pixels, stamp in zip(found, PIXELS, STAMPS, strict=True):
        assert frame.depth.dtype == np.uint16
        assert np.abs(frame.depth - 1000.0 * unit * pixels).max() < 0.501
        assert abs(frame.stamp - stamp) < 1000
        assert frame.camera.intrinsics == INTRINSICS
        assert frame.camera.floor.d == 0.4
        sensor = realsense_sensor.sensor_of(21.0, baseline)
        assert (frame.camera.range, frame.camera.noise, frame.camera.baseline) == sensor
        check_camera(frame.camera)


def test_a_ros_1_bag_whose_images_carry_their_unit():
    check(OLD, 0.00025, 0.0)


def test_a_ros_2_bag_whose_messages_are_compressed():
    check(NEW, 0.0001, 0.018)


@pytest.mark.parametrize("compressed", [False, True])
def test_what_the_installed_librealsense_records(tmp_path, compressed):
    pytest.importorskip(
        "pyrealsense2", reason="needs the extra realsense and Debian's package libusb-1.0-0", exc_type=ImportError
    )
    from tests.realsense_file import record

    check(record(tmp_path / "drive.db3", 0.00025, 0.05, compressed), 0.00025, 0.05)


def edited(path, edit):
    """A copy of OLD. edit: of a topic and its bytes, or None, which leaves the message out, makes what is written."""
    with Reader(OLD) as reader, Writer(path) as writer:
        copies = {
            each.id: writer.add_connection(each.topic, each.msgtype, msgdef=each.msgdef.data, md5sum=each.digest)
            for each in reader.connections
        }
        for connection, stamp, data in reader.messages():
            if (made := edit(connection.topic, data)) is not None:
                writer.write(copies[connection.id], stamp, made)
    return path


def without_unit(topic, data):
    """As old versions wrote: a header without a frame, and nothing behind the pixels."""
    return data[:12] + struct.pack("<I", 0) + data[17:-4] if topic == IMAGES else data


def test_an_old_bag_has_the_unit_of_the_sensors_option(tmp_path):
    check(edited(tmp_path / "old.bag", without_unit), 0.00025, 0.0)


def test_an_option_that_changed_counts_from_then_on(tmp_path):
    bag = edited(tmp_path / "old.bag", without_unit)
    with Reader(bag) as reader:
        times = [stamp for connection, stamp, _ in reader.messages() if connection.topic == IMAGES]
        with Writer(tmp_path / "changed.bag") as writer:
            for each in reader.connections:
                copy = writer.add_connection(each.topic, each.msgtype, msgdef=each.msgdef.data, md5sum=each.digest)
                for _, stamp, data in reader.messages([each]):
                    writer.write(copy, stamp, data)
                if each.topic == UNIT_TOPIC:
                    writer.write(copy, times[1], struct.pack("<f", 0.001))
    images, _ = frames(tmp_path / "changed.bag")
    assert [frame.depth[0, 0] for frame in images] == [1000, 4001, 4002]


def test_depths_of_an_unknown_unit_are_refused_with_the_remedy(tmp_path):
    def neither(topic, data):
        return None if topic == UNIT_TOPIC else without_unit(topic, data)

    with (
        closing(open_recorded(config(edited(tmp_path / "drive.bag", neither)))) as recorded,
        pytest.raises(BadFrame, match=rf"the depth unit is not known, .* {UNIT_TOPIC} has it: record with a newer"),
    ):
        next(recorded.images()).read()


def test_without_intrinsics_it_is_refused(tmp_path):
    path = edited(tmp_path / "drive.bag", lambda topic, data: None if "camera_info" in topic else data)
    with pytest.raises(ConfigError, match=r"no intrinsics on /device_0/sensor_0/Depth_0/info/camera_info: record"):
        open_recorded(config(path))


@pytest.mark.parametrize("topic", [UNIT_TOPIC, "/device_0/sensor_0/Depth_0/info/camera_info", IMAGES, "/tf_static"])
def test_messages_of_another_type_on_a_topic_are_passed_over(tmp_path, topic):
    with Reader(OLD) as reader, Writer(tmp_path / "drive.bag") as writer:
        text = next(each for each in reader.connections if each.msgtype == "std_msgs/msg/String")
        strange = writer.add_connection(topic, text.msgtype, msgdef=text.msgdef.data, md5sum=text.digest)
        writer.write(strange, 0, struct.pack("<I", 4) + b"none")
        for each in reader.connections:
            copy = writer.add_connection(each.topic, each.msgtype, msgdef=each.msgdef.data, md5sum=each.digest)
            for _, stamp, data in reader.messages([each]):
                writer.write(copy, stamp, data)
    check(tmp_path / "drive.bag", 0.00025, 0.0)


def test_images_of_another_format_are_refused(tmp_path):
    path = edited(tmp_path / "drive.bag", lambda _, data: data.replace(b"mono16", b"mono17"))
    with closing(open_recorded(config(path))) as recorded, pytest.raises(BadFrame, match="expected mono16: record the"):
        next(recorded.images()).read()


def test_check_data_names_the_unit_and_the_camera(capsys):
    check_data(OLD, config(OLD), StopSignal())
    said = capsys.readouterr().out
    assert f"{OLD}: ROS 1 bag of librealsense, 3 depth images" in said
    assert "units: 0.25 mm as recorded, which become millimetres" in said
    assert "noise: 0.00200 1/m, an L515's, for no Stereo_Baseline is recorded" in said


@pytest.mark.parametrize(
    ("read", "bad"),
    [
        (wire.shot, "timestamp=soon"),
        (wire.shot, "depth_units=0.001"),
        (wire.shot, "timestamp=inf"),
        (wire.stream_calibration, "width=32;height=24"),
        (wire.number, "none"),
        (wire.expanded, wire.ZSTD + b"nothing of the kind"),
        (wire.expanded, wire.ZSTD + bytes.fromhex("a0000000ff")),  # which claims four gigabytes
    ],
)
def test_damaged_messages_are_one_line(read, bad):
    with pytest.raises(BadFrame, match="a message that cannot be decoded") as told:
        read(bad)
    assert "\n" not in str(told.value)
