"""How a service takes in messages: bad ones are counted and told, and the next good one is worked on as ever."""

import numpy as np
import pytest

from cliffscan.common.contract.depth_codec import ENCODINGS
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.contract.topics import DEPTH, SCAN_POSITIVE
from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.common.runtime.config import ConfigError
from tests import build

BAD = {
    "nothing": b"",
    "no msgpack": b"\xc1\xc1",
    "no map": build.payload([1, 2]),
    "another message": build.payload(build.scan_fields()),
    "wrong size": build.payload(build.depth_fields(width=640)),
    "nan": build.payload(build.depth_fields(floor=[0, -1, 0, float("nan")])),
    "impossible plane": build.payload(build.depth_fields(floor=[0, 0, 0, 1])),
    "unknown encoding": build.payload(build.depth_fields(encoding="jpeg")),
}


def frame(seq, stamp, **changes):
    return build.payload(build.depth_fields(seq=seq, stamp=stamp, **changes))


@pytest.fixture
def service():
    return build.service("positive", ImageScanConfig())


@pytest.fixture
def taken(service):
    """What the service takes in from camera/depth."""
    taken = []
    service.receive(DEPTH, taken.append)
    return taken


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_message_costs_itself_only(service, taken, caplog, kind):
    for data in (frame(1, 10), BAD[kind], frame(2, 20)):
        service.bus.arrive("camera/depth", data)
    assert [image.stamp for image in taken] == [10, 20]
    assert service.metrics.counts() == {"received": 2, "malformed": 1}
    (told,) = caplog.messages
    assert told.startswith("malformed (1 so far): camera/depth: ")
    assert "\n" not in told


def test_a_stamp_that_goes_back_is_told_of(service, taken, caplog):
    for seq, stamp in enumerate([10, 20, 5, 6]):
        service.bus.arrive("camera/depth", frame(seq, stamp))
    assert [image.stamp for image in taken] == [10, 20, 5, 6]
    assert service.metrics.counts() == {"received": 4, "stamp_back": 1}
    assert "camera/depth: stamp 5 comes 15 ns before" in caplog.text


def test_a_second_camera_on_the_key_is_told_of(service, taken, caplog):
    for seq, stamp in [(500, 10), (1, 11), (501, 12), (2, 13)]:
        service.bus.arrive("camera/depth", frame(seq, stamp))
    assert len(taken) == 4
    assert service.metrics.counts() == {"received": 4, "sequence_back": 2}
    assert "two cameras share this key" in caplog.text


def test_frames_of_another_size_in_mid_stream_are_taken(service, taken):
    service.bus.arrive("camera/depth", frame(1, 10))
    service.bus.arrive("camera/depth", frame(2, 20, width=2, height=3, intrinsics=[3, 3, 1, 1], region=[0, 0, 1, 2]))
    assert [image.depth.shape for image in taken] == [(2, 3), (3, 2)]


def test_a_bad_message_does_not_count_for_the_order_of_stamps(service, taken):
    for data in (frame(1, 10), frame(2, 2**60, width=9), frame(3, 20)):
        service.bus.arrive("camera/depth", data)
    assert [image.stamp for image in taken] == [10, 20]


def test_each_key_has_an_order_of_its_own(service, taken):
    scans = []
    service.receive(SCAN_POSITIVE, scans.append)
    service.bus.arrive("camera/depth", frame(1, 20))
    service.bus.arrive("scan/positive", build.payload(build.scan_fields(stamp=10)))
    assert (len(taken), len(scans)) == (1, 1)


def test_every_encoding_is_taken(service, taken):
    view, depth = build.camera(), np.full((48, 64), 1234, np.uint16)
    for seq, encoding in enumerate(ENCODINGS):
        service.bus.arrive("camera/depth", DepthImage.pack(seq, seq, "f", depth, view, encoding).encode())
    assert [(image.depth == 1234).all() for image in taken] == [True] * len(ENCODINGS)


def test_a_slow_service_takes_the_newest_and_counts_the_overtaken(service):
    service.bus.on_announce = lambda: [service.bus.arrive("camera/depth", frame(n, n)) for n in range(5)]
    newest = service.newest(DEPTH)
    assert next(newest).stamp == 4
    service.bus.arrive("camera/depth", frame(5, 5))
    assert next(newest).stamp == 5
    assert service.metrics.counts() == {"received": 6, "overtaken": 4}
    service.stop.set()
    assert list(newest) == []


def test_a_service_is_ready_when_its_subscription_stands(service):
    heard = []
    service.bus.on_announce = lambda: heard.extend(service.bus.receivers)
    assert service.state == "starting"
    service.stop.set()
    assert list(service.newest(DEPTH)) == []
    assert heard == ["camera/depth"]
    assert service.bus.announced == ["positive"]
    assert service.state == "working"


def test_a_status_tells_counts_rate_and_latency(service):
    service.metrics.count("received", 60)
    for _ in range(30):
        service.metrics.output(0)
    service.publish_status()
    (told,) = service.bus.said["status/positive"]
    assert (told.service, told.state, told.counts) == ("positive", "starting", {"received": 60, "published": 30})
    assert told.rate > 0
    assert told.latency[0] > 0
    assert type(told).decode(told.encode()) == told


def test_what_a_person_should_know_of_the_keys_is_in_the_status(service):
    service.note = "no frame"
    service.bus.notice = lambda: "its certificate expires in 5 days"
    service.publish_status()
    assert service.bus.said["status/positive"][-1].note == "no frame; its certificate expires in 5 days"


def test_the_alive_file_is_there_while_the_service_works(tmp_path, monkeypatch):
    file = tmp_path / "alive"
    monkeypatch.setenv("CLIFFSCAN_ALIVE_FILE", str(file))
    file.touch()
    service = build.service("positive", ImageScanConfig())
    assert not file.exists(), "a killed process left it"
    for _ in range(2):
        service.announce()
        assert file.exists()
        service.waiting("a device is gone")
        assert not file.exists()


def test_an_alive_file_that_cannot_be_is_refused_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("CLIFFSCAN_ALIVE_FILE", str(tmp_path / "none/alive"))
    with pytest.raises(ConfigError, match="none/alive: No such file or directory: name a file"):
        build.service("positive", ImageScanConfig()).announce()
