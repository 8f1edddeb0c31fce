"""Capture goes on whatever happens to its source: a lost device is opened again, a bad frame is left out."""

import numpy as np
import pytest

from common.config import ConfigError
from common.messages import DepthImage
from services.capture import __main__ as capture
from services.capture.config import CaptureConfig
from services.capture.source import BadFrame, DepthFrame, SourceEnded, SourceLost
from tests import build

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

    def open(self, _config):
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
    assert service.tally.counts() == {}


def test_a_bad_frame_is_counted_told_and_left_out(service, play, caplog):
    stamps, script = play([frame(1), BadFrame("000.png: truncated"), frame(2)])
    assert stamps == [1, 2]
    assert service.tally.counts() == {"bad_frame": 1}
    assert "000.png: truncated" in caplog.text
    assert script.opened == 1


def test_a_lost_device_is_opened_again(service, play, caplog):
    stamps, script = play([frame(1), SourceLost("Kinect 0 is gone")], [frame(2)])
    assert stamps == [1, 2]
    assert (script.opened, script.closed) == (2, 2)
    assert service.tally.counts() == {"source_lost": 1}
    assert "Kinect 0 is gone; trying again in 0.5 s" in caplog.text


def test_a_device_that_stays_away_is_waited_for_longer_and_longer(service, play):
    play(*[SourceLost("none")] * 7, [frame(1)])
    assert service.stop.waits == [0.5, 1, 2, 4, 8, 8, 8]
    assert service.tally.counts() == {"source_lost": 7}


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


def test_a_service_is_not_ready_before_its_source_is(service, play):
    play(SourceLost("none"), SourceLost("none"))
    assert len(service.bus.announced) == 1  # by the third opening, which went well


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
    assert service.tally.take_outputs() == 2
