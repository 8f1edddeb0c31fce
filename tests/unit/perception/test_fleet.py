"""Which robots perception serves, and for how long."""

from types import SimpleNamespace

import numpy as np
import pytest

from cliffscan.services.perception import fleet as module
from cliffscan.services.perception.configs import load
from cliffscan.services.perception.fleet import SILENCE, Fleet
from cliffscan.services.perception.standing import MOST, SETTLED
from cliffscan.services.perception.turns import ROOM
from tests import build


class Bus(build.Bus):
    """The buses of several robots; `of` has them by name."""

    def __init__(self, robot="", of=None):
        super().__init__()
        self.robot, self.of = robot, {} if of is None else of
        self.retracted = 0

    def beside(self, robot):
        return self.of.setdefault(robot, Bus(robot, self.of))

    def retract(self):
        self.retracted += 1


def image(stamp):
    return build.payload(build.depth_fields(stamp=stamp, data=np.full(6, 900, "<u2").tobytes()))


@pytest.fixture
def clock(monkeypatch):
    clock = SimpleNamespace(now=100.0)
    clock.monotonic = lambda: clock.now
    monkeypatch.setattr(module, "time", clock)
    return clock


@pytest.fixture
def bus():
    return Bus()


@pytest.fixture
def every(bus, clock):
    """A Fleet for every robot."""
    return Fleet(bus, None, load(None, ["scan.beams=8"]), build.Stop())


def settle(fleet, clock):
    """Let tokens reach everybody, if there were others."""
    for _ in range(4):
        clock.now += SETTLED
        fleet._review()


def stamps(bus, robot):
    return [scan.stamp for scan in bus.of[robot].said["scan/fused"]]


def test_a_robot_is_served_from_its_first_good_image_on(every, bus, clock):
    every._take("a", [b"no image"])
    settle(every, clock)
    assert "a" not in bus.of
    every._take("a", [b"no image", image(7)])
    settle(every, clock)
    every._take("a", [image(8)])
    assert stamps(bus, "a") == [7, 8]
    claim, *tokens = bus.of["a"].announced
    assert claim.startswith("perception/")
    assert set(tokens) == {"negative", "positive", "fuse", "perception"}


def test_a_silent_robot_is_left_and_served_again_when_it_comes_back(every, bus, clock):
    every._take("a", [image(7)])
    settle(every, clock)
    clock.now += SILENCE - 2.0
    every._take("b", [image(7)])
    settle(every, clock)
    clock.now += 2.0
    every._review()
    assert (bus.of["a"].retracted, bus.of["b"].retracted) == (4, 0)
    assert bus.of["a"].withdrawn == 1
    every.publish_statuses()
    assert not bus.of["a"].said["status/fuse"]
    assert len(bus.of["b"].said["status/fuse"]) == 1
    every._take("a", [image(9)])
    settle(every, clock)
    assert stamps(bus, "a") == [7, 9]


def test_a_robot_that_was_named_is_never_left(bus, clock):
    fleet = Fleet(bus, ["a"], load(None, []), build.Stop())
    settle(fleet, clock)
    clock.now += 10 * SILENCE
    fleet._review()
    assert "perception" in bus.of["a"].announced
    assert bus.of["a"].retracted == 0


def test_only_the_newest_of_several_images_is_answered(every, bus, clock):
    every._take("a", [image(7)])
    settle(every, clock)
    every._take("a", [image(8), image(9)])
    every.publish_statuses()
    assert stamps(bus, "a") == [7, 9]
    for part in ("negative", "positive", "perception"):
        (told,) = bus.of["a"].said[f"status/{part}"]
        assert told.counts == {"received": 3, "overtaken": 1, "published": 2}


def test_more_robots_than_can_be_served_are_told_of(every, bus, clock, caplog):
    for number in range(MOST + 1):
        every._take(f"r{number:03}", [image(7)])
    settle(every, clock)
    assert f"r{MOST:03}" not in bus.of
    assert f"r{MOST:03}: {MOST} robots are served already" in caplog.text


def test_images_are_kept_of_no_more_robots_than_can_be_served(every, clock):
    for number in range(2 * MOST):
        every._take(f"r{number:03}", [image(7)])
    assert list(every._first) == [f"r{number:03}" for number in range(MOST, 2 * MOST)]
    every._take(f"r{MOST:03}", [image(8)])
    every._take("r000", [image(8)])
    assert list(every._first)[-2:] == [f"r{MOST:03}", "r000"]  # the one whose image is oldest was given up


def test_no_image_is_kept_of_a_robot_that_is_not_to_be_served(every, clock):
    for number in range(MOST + 2):
        every._take(f"r{number:03}", [image(7)])
    settle(every, clock)
    assert every._first == {}
    every._take(f"r{MOST:03}", [image(8)])
    assert every._first == {}
    every._take("a", [image(7)])
    every._news.append(lambda: every._standings.token("a", "perception/other", True))
    every._review()
    assert every._first == {}


def test_the_image_of_a_robot_that_another_process_served_is_not_answered_again(every, bus, clock):
    every._standings.token("a", "perception/other", True)
    every._take("a", [image(7)])
    every._standings.token("a", "perception/other", False)
    settle(every, clock)
    every._take("a", [image(8)])
    assert stamps(bus, "a") == [8]


def test_the_samples_of_a_robot_that_is_left_are_not_worked_on(every, bus, clock):
    every._take("a", [image(7)])
    settle(every, clock)
    every._arrived("a", image(8))
    every._news.append(lambda: every._standings.token("a", "perception/own", True))
    settle(every, clock)
    assert bus.of["a"].retracted == 4
    assert every._turns.take(0.0) is None
    assert not every._wanted("a")


def test_more_frames_than_there_is_time_for_are_told_of(every, bus, clock, caplog):
    for robot in "ab":
        every._take(robot, [image(7)])
    settle(every, clock)
    for seq in range(ROOM + 1):  # they wait: the process is not idle
        for robot in "ab":
            every._arrived(robot, image(seq))
    for _ in range(2):
        for robot in "ab" * 30:
            clock.now += 1 / 60
            if every._wanted(robot):
                every._admission.worked(robot, 1 / 36)
        every._review()
    every._take("a", [image(8)])
    every.publish_statuses()
    told = bus.of["a"].said["status/perception"][-1]
    assert told.note == "16 of 30 frames a second are taken"
    assert told.counts["not_taken"] == pytest.approx(14, abs=2)
    assert "a 16 of 30, b 16 of 30; serve some by another process" in caplog.text


def test_no_more_samples_of_a_robot_are_taken_than_its_rate_allows(every, clock):
    taken = 0
    for _ in range(1000):
        clock.now += 0.0005
        taken += every._wanted("flood")
    assert taken == pytest.approx(0.5 * module.RATE + module.BURST, abs=2)
    assert every._wanted("another")


@pytest.mark.parametrize(
    ("payload", "stays"),
    [
        (build.payload(build.status_fields(service="negative", state="working")), False),
        (build.payload(build.status_fields(service="negative", state="starting")), True),
        (b"no status", True),
    ],
)
def test_a_robot_is_left_to_a_service_that_works(every, bus, clock, payload, stays):
    every._take("a", [image(7)])
    settle(every, clock)
    settle(every, clock)
    clock.now += 1.0
    every._status_of("negative", "a", payload)
    every._review()
    assert every._serves("a") is stays
