"""Recordings of ROS messages are replayed as a live camera is: bags of both kinds and MCAP files."""

from contextlib import closing, suppress
from itertools import pairwise

import pytest

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import BadFrame, SourceEnded
from cliffscan.services.capture.sources.open_source import open_source
from tests.own_recordings import DEPTHS, INFO, KINDS, TOPIC, break_chunk, record, stamp_of


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
    assert [frame.stamp for frame in played] == [stamp_of(number) for number in range(3)]
    for frame in played:
        assert frame.camera.intrinsics == (3.0, 2.5, 1.0, 0.5)
        assert frame.camera.floor == pytest.approx((0.0, -1.0, 0.0, 0.7))
        assert frame.place == pytest.approx((0.1, 0.0, 0.0))


@pytest.mark.parametrize("kind", ["bag", "sqlite", "mcap of its project"])
@pytest.mark.parametrize("topic", [TOPIC, INFO, "/tf_static"])
def test_messages_of_another_type_on_a_topic_are_passed_over(tmp_path, kind, topic):
    played = frames(opened(record(tmp_path, kind, texts=[topic]), loop=False))
    assert [frame.stamp for frame in played] == [stamp_of(number) for number in range(3)]
    assert [frame.camera.floor.d for frame in played] == pytest.approx([0.7] * 3)


@pytest.mark.parametrize("kind", ["bag", "sqlite", "mcap of its project"])
def test_a_damaged_message_costs_its_frame_only(tmp_path, kind):
    source = opened(record(tmp_path, kind, damaged=[1]), loop=False)
    assert source.read(1.0).stamp == stamp_of(0)
    with pytest.raises(BadFrame, match="a message that cannot be decoded") as told:
        source.read(1.0)
    assert "\n" not in str(told.value)
    assert [frame.stamp for frame in frames(source)] == [stamp_of(2)]


def test_where_a_file_is_damaged_between_its_messages_it_ends_with_one_line(tmp_path):
    path = record(tmp_path, "mcap of its project")
    break_chunk(path, -2)  # of the last image, before its CameraInfo
    source = opened(path, loop=False)
    assert [source.read(1.0).stamp for _ in range(2)] == [stamp_of(0), stamp_of(1)]
    with pytest.raises(BadFrame, match=r"the rest of drive.mcap cannot be read \(.*\): mend one that was cut by"):
        source.read(1.0)
    assert frames(source) == []


def test_a_further_round_goes_on_from_the_last_stamp(tmp_path):
    source = opened(record(tmp_path, "bag"), loop=True)
    stamps = []
    while len(stamps) < 7:
        frame = source.read(1.0)
        stamps += [frame.stamp] if frame else []
    source.close()
    assert all(after > before for before, after in pairwise(stamps))


def test_of_several_depth_topics_one_is_named(tmp_path):
    path = record(tmp_path, "bag", topics=[TOPIC, "/rear/depth/image"])
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
