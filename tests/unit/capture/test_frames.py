"""Capture goes on whatever happens to its source: a lost device is opened again, a bad frame is left out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture import __main__ as capture
from cliffscan.services.capture import description
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources import frozen
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame, SourceEnded, SourceLost
from tests import build, scenes

CAMERA = build.camera(4, 3, 4.0)


def frame(stamp):
    return DepthFrame(np.full((3, 4), stamp, np.uint16), stamp, CAMERA)


class Script:
    """Sources that do as written, one list of events for each time one is opened; then all is at its end.

    An event is a frame, None (no frame in time) or an exception; an exception in a list's place is the opening's.
    """

    def __init__(self, *openings):
        self.openings = list(openings)
        self.opened = self.closed = 0
        self.timeouts = []

    def open(self, _config, _service):
        self.opened += 1
        self.events = self.openings.pop(0) if self.openings else [SourceEnded()]
        if isinstance(self.events, Exception):
            raise self.events
        return self

    def read(self, timeout):
        self.timeouts.append(timeout)
        event = self.events.pop(0) if self.events else SourceEnded()
        if isinstance(event, Exception):
            raise event
        return event

    def close(self):
        self.closed += 1


@pytest.fixture
def service():
    return build.service("capture", CaptureConfig(source="kinect", floor="fixed"))


@pytest.fixture
def play(service, monkeypatch):
    """The stamps of all frames of a script, and the script afterwards."""

    def stamps(*openings):
        script = Script(*openings)
        monkeypatch.setattr(capture, "open_source", script.open)
        return [frame.stamp for frame in capture.frames(service)], script

    return stamps


def test_frames_come_in_order_until_the_end(service, play):
    stamps, script = play([frame(1), None, frame(2), None, None, frame(3)])
    assert stamps == [1, 2, 3]
    assert (script.opened, script.closed) == (1, 1)
    assert max(script.timeouts) <= 0.1
    assert service.metrics.counts() == {}


def test_a_bad_frame_is_counted_told_and_left_out(service, play, caplog):
    stamps, script = play([frame(1), BadFrame("000.png: truncated"), frame(2)])
    assert stamps == [1, 2]
    assert service.metrics.counts() == {"bad_frame": 1}
    assert "000.png: truncated" in caplog.text
    assert script.opened == 1


def test_a_lost_device_is_opened_again(service, play, caplog):
    stamps, script = play([frame(1), SourceLost("Kinect 0 is gone")], [frame(2)])
    assert stamps == [1, 2]
    assert (script.opened, script.closed) == (2, 2)
    assert service.metrics.counts() == {"source_lost": 1}
    assert "Kinect 0 is gone; trying again in 0.5 s" in caplog.text


def test_a_device_that_stays_away_is_waited_for_longer_and_longer(service, play):
    play(*[SourceLost("none")] * 7, [frame(1)])
    assert service.stop.waits == [0.5, 1, 2, 4, 8, 8, 8]
    assert service.metrics.counts() == {"source_lost": 7}


def test_a_frame_makes_the_next_wait_short_again(service, play):
    play(*[SourceLost("none")] * 3, [frame(1), SourceLost("gone")], SourceLost("none"), [frame(2)])
    assert service.stop.waits == [0.5, 1, 2, 0.5, 1]


def test_a_device_that_opens_and_sends_nothing_is_waited_for_longer_and_longer(service, play):
    play(*[[None, SourceLost("silent")] for _ in range(3)], [frame(1)])
    assert service.stop.waits == [0.5, 1, 2]


def test_the_state_tells_whether_there_is_a_device(service, monkeypatch):
    script = Script([frame(1), SourceLost("unplugged")], [frame(2)])
    monkeypatch.setattr(capture, "open_source", script.open)
    heard = []
    monkeypatch.setattr(service, "pause", lambda _seconds: heard.append((service.state, service.note)))
    states = [(service.state, service.note) for _ in capture.frames(service)]
    assert states == [("working", "")] * 2
    assert heard == [("waiting", "unplugged")]


def test_a_service_is_not_ready_before_its_source_brings_a_frame(service, play):
    play(SourceLost("none"), [None, BadFrame("cut"), SourceLost("silent")])
    assert service.bus.announced == []
    play([None, BadFrame("cut"), frame(1), frame(2)])
    assert service.bus.announced == ["capture"]


def test_the_token_goes_with_the_device_and_comes_again_with_its_frames(service, monkeypatch):
    script = Script([frame(1), SourceLost("unplugged")], SourceLost("none"), [frame(2)])
    monkeypatch.setattr(capture, "open_source", script.open)
    tokens = [(len(service.bus.announced), service.bus.withdrawn) for _ in capture.frames(service)]
    assert tokens == [(1, 0), (2, 2)]


def again(picture, stamp):
    """A frame with the depths of another one and a stamp of its own."""
    return DepthFrame(picture.depth.copy(), stamp, CAMERA)


def test_a_repeated_picture_is_left_out_counted_and_told_in_the_status(service, monkeypatch):
    script = Script([frame(1), again(frame(1), 2), None, frame(3)])
    monkeypatch.setattr(capture, "open_source", script.open)
    notes = []
    monkeypatch.setattr(script, "read", lambda timeout: notes.append(service.note) or Script.read(script, timeout))
    assert [each.stamp for each in capture.frames(service)] == [1, 3]
    assert service.metrics.counts() == {"frozen": 1}
    assert notes[:2] == ["", ""]
    assert all("repeats its last picture" in note for note in notes[2:4])
    assert notes[4] == ""
    assert script.opened == 1


def test_a_frozen_device_is_opened_again_later_and_later_and_its_old_picture_stays_out(service, play, monkeypatch):
    monkeypatch.setattr(frozen, "PATIENCE", 0.0)
    hung = [again(frame(1), stamp) for stamp in (2, 3, 4)]
    stamps, script = play([frame(1), hung[0]], [hung[1]], [hung[2]], [frame(5)])
    assert stamps == [1, 5]
    assert script.opened == script.closed == 4
    assert service.stop.waits == [0.5, 1, 2]
    assert service.metrics.counts() == {"frozen": 3, "source_lost": 3}
    assert (len(service.bus.announced), service.bus.withdrawn) == (2, 3)


def test_a_recording_may_show_one_picture_again_and_again(monkeypatch):
    service = build.service("capture", CaptureConfig(source="replay", floor="fixed"))
    script = Script([frame(1), again(frame(1), 2), again(frame(1), 3)])
    monkeypatch.setattr(capture, "open_source", script.open)
    assert [each.stamp for each in capture.frames(service)] == [1, 2, 3]


def of(stamp, **changes):
    """A frame of a camera that is another one by these fields."""
    return frame(stamp)._replace(camera=replace(CAMERA, **changes))


@pytest.fixture
def clock(monkeypatch):
    """Stands in for the description's module `time`."""
    clock = SimpleNamespace(now=50.0, time_ns=lambda: 17)
    clock.monotonic = lambda: clock.now
    monkeypatch.setattr(description, "time", clock)
    return clock


def test_the_camera_is_described_before_the_service_is_ready(service, play, clock):
    said = service.bus.said["description"]
    service.bus.on_announce = lambda: said.append("ready")
    play([frame(1), frame(2), frame(3)])
    assert said[1:] == ["ready"]
    assert said[0].camera == CameraDescription.of(CAMERA, service.config.frame, simulated=False)
    assert said[0].stamp == 17


def test_a_device_that_comes_back_is_described_where_it_is_another(service, play, clock):
    near = of(3, range=(0.5, 2.0))
    play([frame(1), SourceLost("gone")], [frame(2), SourceLost("gone")], [near])
    first, second = service.bus.said["description"]
    assert second.camera == CameraDescription.of(near.camera, service.config.frame, simulated=False) != first.camera


@pytest.mark.parametrize("change", [{"range": (0.5, 2.0)}, {"floor": FloorPlane.from_mount(0.5)}])
def test_a_camera_that_changes_is_described_again_but_not_with_every_frame(service, monkeypatch, clock, change):
    frames = [of(stamp, **(change if stamp % 2 else {})) for stamp in range(1, 100)]
    monkeypatch.setattr(capture, "open_source", Script(frames).open)
    for _ in capture.frames(service):
        clock.now += 0.125
    assert 3 <= len(service.bus.said["description"]) <= 1 + (clock.now - 50.0) / description.SOONEST


def test_a_floor_that_is_measured_in_each_frame_is_described_once(monkeypatch):
    service = build.service("capture", CaptureConfig(source="kinect"))
    view = scenes.camera(320, 240, FloorPlane.from_mount(0.31), (0.5, 4.5))
    depths = [scenes.depth(scenes.camera(320, 240, FloorPlane.from_mount(h), (0.5, 4.5)), wall=20) for h in (0.3, 0.32)]
    monkeypatch.setattr(capture, "open_source", Script([DepthFrame(d, 1, view) for d in depths]).open)
    monkeypatch.setattr(description, "SOONEST", 0.0)
    floors = {each.camera.floor for each in capture.frames(service)}
    assert len(floors | {view.floor}) == 3
    (told,) = service.bus.said["description"]
    assert told.camera == CameraDescription.of(view, service.config.frame, simulated=False)


def test_the_nearest_floor_that_is_described_follows_the_border_that_is_learnt(monkeypatch):
    service = build.service("capture", CaptureConfig(source="kinect"))
    view = scenes.camera(320, 240, FloorPlane.from_mount(0.3), (0.3, 9.0))
    picture = np.where(np.arange(240)[:, None] < 220, scenes.depth(view), 0)
    depths = [(scale * picture).astype(np.uint16) for scale in (1.0, 1.2, 1.5, 1.6)]
    monkeypatch.setattr(capture, "open_source", Script([DepthFrame(d, 1, view) for d in depths]).open)
    monkeypatch.setattr(description, "SOONEST", 0.0)
    assert [each.camera.region.last_row for each in capture.frames(service)] == [239, 239, 219, 219]
    before, after = (each.camera.nearest_floor for each in service.bus.said["description"])
    fy, cy = view.intrinsics.fy, view.intrinsics.cy
    assert (before, after) == pytest.approx((0.3 * fy / (239 - cy), 0.3 * fy / (219 - cy)))


@pytest.mark.parametrize(("source", "simulated"), [("kinect", False), ("simulator", True), ("replay", True)])
def test_what_is_not_of_here_and_now_is_described_as_simulated(monkeypatch, source, simulated):
    service = build.service("capture", CaptureConfig(source=source, floor="fixed"))
    monkeypatch.setattr(capture, "open_source", Script([frame(1)]).open)
    assert len(list(capture.frames(service))) == 1
    (told,) = service.bus.said["description"]
    assert told.camera.simulated == simulated


def test_a_source_that_can_never_be_opened_ends_the_service(play):
    with pytest.raises(ConfigError, match="no folder"):
        play(ConfigError("no folder"))


def test_a_service_that_is_told_to_end_lets_go_of_its_source(service, monkeypatch):
    script = Script([frame(stamp) for stamp in range(10)])
    monkeypatch.setattr(capture, "open_source", script.open)
    taken = []
    for each in capture.frames(service):
        taken.append(each.stamp)
        if each.stamp == 3:
            service.stop.set()
    assert taken == [0, 1, 2, 3]
    assert script.closed == 1


def test_a_service_that_is_told_to_end_does_not_open_its_source_again(service, monkeypatch):
    script = Script([SourceLost("gone")])
    monkeypatch.setattr(capture, "open_source", script.open)
    monkeypatch.setattr(service, "pause", lambda _seconds: service.stop.set())
    assert list(capture.frames(service)) == []
    assert script.opened == 1


@pytest.mark.parametrize(("compressed", "encoding"), [(True, "16UC1;levels;zstd"), (False, "16UC1")])
def test_every_frame_is_published_with_its_camera(monkeypatch, compressed, encoding):
    service = build.service("capture", CaptureConfig(source="kinect", compressed=compressed, frame="kinect"))
    monkeypatch.setattr(capture, "open_source", Script([frame(7), BadFrame("x"), frame(9)]).open)
    capture.serve(service)
    said = [DepthImage.decode(image.encode()) for image in service.bus.said["camera/depth"]]
    assert [(image.seq, image.stamp, image.encoding, image.frame) for image in said] == [
        (0, 7, encoding, "kinect"),
        (1, 9, encoding, "kinect"),
    ]
    assert (said[1].depth == 9).all()
    assert said[1].camera == CAMERA
    assert service.metrics.take_outputs() == 2
