"""Fuse publishes one scan for a frame whose scans are all there, and counts what it cannot complete."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cliffscan.services.fuse import __main__ as module
from cliffscan.services.fuse import fuser
from cliffscan.services.fuse.config import FuseConfig
from tests import build
from tests.build import SECOND, scan

INF, NAN = math.inf, math.nan
WITH_LIDAR = FuseConfig(inputs={"lidar": {"key": "scan/lidar"}})


class Clock:
    """Stands in for the module `time`."""

    now = 0.0

    def monotonic(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(fuser, "time", clock)
    return clock


class Rig:
    """A Fuser, and what it published."""

    def __init__(self, config):
        self.service = build.service("fuse", config)
        self.fuser = fuser.Fuser(self.service)

    def take(self, name, stamp, ranges=(1.0, INF)):
        self.fuser.take(name, scan(list(ranges), stamp=stamp))

    @property
    def said(self):
        return self.service.bus.said["scan/fused"]

    @property
    def counts(self):
        return self.service.metrics.counts()


@pytest.fixture
def plain(clock):
    return Rig(FuseConfig())


@pytest.fixture
def rig(clock):
    return Rig(WITH_LIDAR)


def test_a_complete_frame_is_published_at_once(plain):
    plain.take("positive", 7, [2.0, INF])
    assert plain.said == []
    plain.take("negative", 7, [3.0, 1.0])
    (fused,) = plain.said
    assert fused.stamp == 7
    assert_array_equal(fused.ranges, np.float32([2, 1]))
    assert plain.service.metrics.take_outputs() == 1
    assert plain.counts == {"published": 1}


@pytest.mark.parametrize("subscribed", [True, False])
def test_the_safe_scan_is_made_while_somebody_subscribes(clock, monkeypatch, subscribed):
    def publisher(bus, topic):
        return SimpleNamespace(put=bus.said[topic.path].append, has_subscribers=subscribed)

    monkeypatch.setattr(build.Bus, "publisher", publisher)
    rig = Rig(FuseConfig())
    for side, clear in (("positive", [2.0, 5.0]), ("negative", [1.0, 5.0])):
        rig.fuser.take(side, scan([2.0, INF], clear=clear, stamp=7))
    (fused,), safe = rig.said, rig.service.bus.said["scan/safe"]
    assert_array_equal(fused.ranges, np.float32([2, INF]))
    assert len(safe) == subscribed
    for each in safe:
        assert each.stamp == 7
        assert_array_equal(each.ranges, np.float32([NAN, INF]))


def test_half_a_frame_is_never_published_but_counted(plain, clock, caplog):
    plain.take("positive", 7)
    for clock.now in (0.1, 0.4, 0.6):
        plain.fuser.drop_late()
    plain.take("negative", 7)
    assert plain.said == []
    assert plain.counts == {"incomplete": 1}
    assert "stamp 7: only positive came" in caplog.text


def test_the_next_complete_frame_is_published_as_ever(plain, clock):
    plain.take("positive", 7)
    clock.now = 1.0
    plain.fuser.drop_late()
    for side in ("negative", "positive"):
        plain.take(side, 8)
    assert [fused.stamp for fused in plain.said] == [8]


def test_scans_of_different_beams_are_counted_told_and_left_out(plain, caplog):
    plain.take("positive", 7, [1, 2, 3])
    plain.take("negative", 7, [1, 2])
    plain.take("positive", 8)
    plain.take("negative", 8)
    assert [fused.stamp for fused in plain.said] == [8]
    assert plain.counts == {"mismatch": 1, "published": 1}
    assert "positive has" in caplog.text


def test_an_extra_input_is_fused_in(rig):
    rig.take("lidar", 7, [NAN, 0.5])
    for side in ("positive", "negative"):
        rig.take(side, 7, [INF, INF])
    assert rig.said[0].ranges[1] == np.float32(0.5)
    assert rig.said[0].intensities[1] == 5


@pytest.mark.parametrize(("age", "fresh"), [(0.0, True), (0.2, True), (0.201, False), (-0.2, True), (-0.201, False)])
def test_an_extra_input_counts_as_long_as_it_is_fresh(rig, age, fresh):
    rig.take("lidar", round((10 - age) * SECOND))
    for side in ("positive", "negative"):
        rig.take(side, 10 * SECOND)
    assert bool(rig.said) == fresh
    assert rig.counts == ({"published": 1} if fresh else {"incomplete": 1})


def test_without_its_extra_input_no_frame_is_published(rig, caplog):
    for side in ("positive", "negative"):
        rig.take(side, 7)
    assert rig.said == []
    assert rig.counts == {"incomplete": 1}
    assert "stamp 7: no fresh scan of lidar" in caplog.text
    assert rig.service.note == "no fresh scan of lidar"
    rig.take("lidar", 8)
    rig.take("negative", 8)
    rig.take("positive", 8)
    assert rig.service.note == ""


def test_the_newest_of_an_extra_input_counts(rig):
    rig.take("lidar", 6, [1.0, 1.0])
    rig.take("lidar", 7, [2.0, 2.0])
    for side in ("positive", "negative"):
        rig.take(side, 7, [INF, INF])
    assert rig.said[0].ranges.min() == 2.0


def samples(*scans):
    return [(path, scan(ranges, stamp=stamp).encode()) for path, stamp, ranges in scans]


def play(config, arriving, monkeypatch):
    return build.play(module.serve, "fuse", config, arriving, monkeypatch, "cliffscan.services.fuse.__main__")


def test_the_service_listens_to_both_sides_and_its_extra_inputs(monkeypatch):
    arriving = samples(("scan/lidar", 5, [3, 3]), ("scan/negative", 7, [INF, 2]), ("scan/positive", 7, [INF, NAN]))
    service = play(WITH_LIDAR, arriving, monkeypatch)
    assert_array_equal(service.bus.said["scan/fused"][0].ranges, np.float32([3, 2]))
    assert service.bus.announced == ["fuse"]
    assert service.metrics.counts() == {"received": 3, "published": 1}


def test_what_is_malformed_is_counted_and_the_next_frame_fused(monkeypatch):
    bad = build.payload(build.scan_fields(ranges=b"123"))
    good = [(path, 9, [1, 2]) for path in ("scan/positive", "scan/negative")]
    service = play(FuseConfig(), [("scan/positive", bad), ("scan/negative", b""), *samples(*good)], monkeypatch)
    assert [fused.stamp for fused in service.bus.said["scan/fused"]] == [9]
    assert service.metrics.counts() == {"malformed": 2, "received": 2, "published": 1}


def test_the_service_gives_up_what_stays_alone(monkeypatch):
    service = play(FuseConfig(timeout=1e-9), samples(("scan/positive", 7, [1, 2])), monkeypatch)
    assert service.metrics.counts() == {"received": 1, "incomplete": 1}


def test_scans_of_one_beam_do_not_end_the_service(monkeypatch):
    sides = ("scan/lidar", "scan/positive", "scan/negative")
    arriving = samples(*[(side, 7, [1.0]) for side in sides], *[(side, 8, [1, 2]) for side in sides])
    try:
        service = play(WITH_LIDAR, arriving, monkeypatch)
    except ZeroDivisionError as error:
        pytest.fail(f"ended by a scan: {error}")
    assert service.bus.said["scan/fused"][-1].stamp == 8
