"""A recording that is split can be read file by file, and one whose disk is full is whole."""

from collections import namedtuple

import pytest

from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording import record
from cliffscan.recording.parts import Limits, Parts
from cliffscan.recording.reading import Recording
from cliffscan.recording.record import Inbox, Options, Recorder
from tests.build import payload, scan
from tests.recordings import by_rosbags, drive

CAMERA = {
    "frame": "camera_depth_optical_frame",
    "simulated": True,
    "nearest_floor": 0.72,
    "farthest": 5.0,
    "field_of_view": [-0.5, 0.5],
    "height": 0.3,
    "pitch": 0.0,
    "roll": 0.0,
}
STATE = {
    "stamp": 7,
    "bumpers": [False] * 3,
    "cliffs": [False] * 3,
    "cliff_counts": [2000] * 3,
    "wheel_drops": [False] * 2,
    "overcurrents": [False] * 2,
    "currents": [0.1, 0.1],
    "buttons": [False] * 3,
    "battery_voltage": 15.0,
    "battery_percent": 80.0,
    "charger": "discharging",
    "dock_ir": [0] * 3,
    "digital_inputs": [False] * 4,
    "analog_inputs": [0.0] * 4,
}
DESCRIPTION = RawSample("description", "application/msgpack", 7, b"", payload({"stamp": 7, "camera": CAMERA}))


def sample(number, size=0):
    scanned = scan([1.0, 2.0, 3.0], seq=number).encode()
    return RawSample("scan/fused", "application/msgpack", 1000 + number, bytes(size), scanned)


@pytest.mark.parametrize("limits", [Limits(size=2000), Limits(seconds=1e-6)])
def test_each_part_begins_with_what_is_latched(limits, tmp_path):
    with Parts(tmp_path / "drive.mcap", "turtlebot", limits, 0.0) as parts:
        parts.describe(DESCRIPTION)
        parts.describe(DESCRIPTION)  # it comes again and again, and is kept once
        for number in range(4):
            parts.add(sample(number))
            parts.flush()
    files = sorted(tmp_path.iterdir())
    assert [file.name for file in files[:2]] == ["drive_0.mcap", "drive_1.mcap"]
    assert parts.files == len(files)
    assert parts.size == sum(file.stat().st_size for file in files)
    assert parts.newest == files[-1]
    found = []
    for file in files:
        samples, counts = by_rosbags(file)
        assert samples[0] == ("description", DESCRIPTION.payload)
        assert counts["/tf_static"] == 1
        found += [data for path, data in samples if path != "description"]
        assert len([path for path, _ in samples if path == "description"]) == 1
    assert found == [sample(number).payload for number in range(4)]


def test_a_recording_that_cannot_go_on_leaves_a_whole_file(tmp_path):
    later = tmp_path / "drive_1.mcap"
    later.write_text("of somebody else")

    def go_on():
        with Parts(tmp_path / "drive.mcap", "turtlebot", Limits(size=1), None) as parts:
            parts.add(sample(0))
            parts.flush()

    with pytest.raises(FileExistsError):
        go_on()
    recording = Recording(tmp_path / "drive_0.mcap")
    assert list(recording.samples()) == [sample(0)]
    assert recording.damage.words == ""
    assert later.read_text() == "of somebody else"


def test_one_file_is_named_as_it_was_asked_for(tmp_path):
    with Parts(tmp_path / "drive.mcap", "turtlebot", Limits(), None) as parts:
        parts.add(sample(0))
    assert [file.name for file in tmp_path.iterdir()] == ["drive.mcap"]


class Clock:
    """Stops after some turns, and takes no time."""

    def __init__(self, turns):
        self._turns = turns

    def wait(self, _seconds):
        self._turns -= 1
        return self._turns < 0


def test_recording_stops_before_the_disk_is_full_and_leaves_a_whole_file(tmp_path, monkeypatch):
    disk = namedtuple("Disk", "free")
    free = iter([300, 200, 100])
    monkeypatch.setattr(record.shutil, "disk_usage", lambda _folder: disk(next(free)))
    monkeypatch.setattr(record, "FLUSH", 0.0)
    inbox = Inbox(ServiceMetrics())
    path = tmp_path / "a.mcap"
    with Parts(path, "turtlebot", Limits(), None) as parts:
        recorder = Recorder(parts, inbox, Options(path, reserve=150))
        inbox.put(sample(1))
        assert recorder.run(Clock(10))  # as 100 of 150 bytes are free
        inbox.put(sample(2))
    recording = Recording(path)
    assert list(recording.samples()) == [sample(1)]
    assert recording.damage.words == ""


def test_what_came_before_the_end_is_written(tmp_path):
    inbox = Inbox(ServiceMetrics())
    path = tmp_path / "a.mcap"
    with Parts(path, "turtlebot", Limits(), None) as parts:
        recorder = Recorder(parts, inbox, Options(path))
        inbox.put(sample(1))
        inbox.put(DESCRIPTION)
        assert not recorder.run(Clock(0))
    assert [each.path for each in Recording(path).samples()] == ["scan/fused", "description"]
    assert "2 samples" in recorder.summary()


def test_too_many_waiting_samples_are_dropped_and_counted(monkeypatch):
    monkeypatch.setattr(record, "WAITING", 400)
    metrics = ServiceMetrics()
    inbox = Inbox(metrics)
    for number in range(5):
        inbox.put(sample(number))
    kept = inbox.take()
    assert kept == [sample(number) for number in range(len(kept))]
    assert metrics.counts() == {"dropped": 5 - len(kept)}
    assert 0 < len(kept) < 5
    inbox.put(sample(9))
    assert inbox.take() == [sample(9)]


def test_images_are_made_no_more_often_than_told(tmp_path):
    with Parts(tmp_path / "a.mcap", "turtlebot", Limits(), images=2.0) as parts:
        for image in drive(10):
            received = image.seq * 100_000_000  # [ns] 10 Hz
            parts.add(RawSample("camera/depth", "application/msgpack", received, b"", image.encode()))
    _, counts = by_rosbags(tmp_path / "a.mcap")
    assert counts["/cliffscan/native"] == 10
    assert counts["/camera/depth/image_rect_raw"] == counts["/camera/depth/camera_info"] == 2


def test_a_battery_is_not_recorded_as_often_as_a_base_speaks(tmp_path):
    with Parts(tmp_path / "a.mcap", "turtlebot", Limits(), images=0.0) as parts:
        for number in range(500):  # 10 s
            received = 10**18 + number * 20_000_000  # [ns]
            parts.add(RawSample("base/state", "application/msgpack", received, b"", payload(STATE)))
    _, counts = by_rosbags(tmp_path / "a.mcap")
    assert counts["/cliffscan/native"] == 500
    assert 10 <= counts["/battery_state"] <= 20


def test_a_clock_that_is_set_back_does_not_end_the_ros_topics(tmp_path):
    """For as long as it was set back, nothing more of what has a pace was made, and no image."""
    hour = 3600 * 10**9  # [ns]
    image = next(drive(1))
    with Parts(tmp_path / "a.mcap", "turtlebot", Limits(), images=1.0) as parts:
        for begin in (10**18, 10**18 - hour):
            for number in range(100):  # 2 s
                received = begin + number * 20_000_000  # [ns]
                parts.add(RawSample("base/state", "application/msgpack", received, b"", payload(STATE)))
                parts.add(RawSample("camera/depth", "application/msgpack", received, b"", image.encode()))
    _, counts = by_rosbags(tmp_path / "a.mcap")
    assert counts["/battery_state"] >= 2 * 2
    assert counts["/camera/depth/image_rect_raw"] == 2 * 2
