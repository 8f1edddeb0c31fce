"""A live camera that repeats its picture is no camera: the picture is counted, not published, and then lost."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.services.capture.sources import frozen
from cliffscan.services.capture.sources.depth_source import SourceLost
from cliffscan.services.capture.sources.frozen import PATIENCE, FrozenWatch
from cliffscan.simulator.camera import SimulatedKinect
from tests import build  # noqa: F401  the profile of the property tests

PERIOD = 1 / 32  # [s], which binary numbers hold exactly


@pytest.fixture
def clock(monkeypatch):
    clock = SimpleNamespace(now=50.0)
    clock.monotonic = lambda: clock.now
    monkeypatch.setattr(frozen, "time", clock)
    return clock


def picture(number):
    return np.full((3, 4), number, np.uint16)


def watched(watch, clock, numbers):
    """Which of the pictures pass, one a period; "lost" where the device counts as lost."""
    outcomes = []
    for number in numbers:
        clock.now += PERIOD
        try:
            outcomes.append(watch.is_new(picture(number)))
        except SourceLost:
            outcomes.append("lost")
    return outcomes


def test_a_repeated_picture_is_counted_told_and_held_back(clock, caplog):
    metrics = ServiceMetrics()
    assert watched(FrozenWatch(metrics), clock, [7, 7, 7, 8, 8, 7]) == [True, False, False, True, False, True]
    assert metrics.counts() == {"frozen": 3}
    assert "frozen (1 so far): the camera repeats its last picture" in caplog.text


def test_one_pixel_makes_another_picture():
    watch, depth = FrozenWatch(ServiceMetrics()), picture(7)
    assert watch.is_new(depth)
    depth[1, 2] += 1  # a driver that uses its buffer again
    assert watch.is_new(depth)
    assert not watch.is_new(depth)


def test_another_size_is_another_picture():
    watch = FrozenWatch(ServiceMetrics())
    assert watch.is_new(picture(7))
    assert watch.is_new(picture(7).T)


def test_repeats_that_go_on_are_a_lost_device_and_each_opening_has_as_long(clock):
    watch = FrozenWatch(ServiceMetrics())
    repeats = round(PATIENCE / PERIOD)
    assert watched(watch, clock, [7] * (1 + repeats)) == [True] + [False] * repeats
    assert watched(watch, clock, [7]) == ["lost"]
    assert watched(watch, clock, [7] * (1 + repeats)) == [False] * repeats + ["lost"]
    assert watched(watch, clock, [8]) == [True]


def test_a_new_picture_begins_the_patience_anew(clock):
    pictures = np.repeat(range(1, 20), 1 + round(PATIENCE / PERIOD))
    assert "lost" not in watched(FrozenWatch(ServiceMetrics()), clock, pictures)


def test_a_lost_device_names_the_remedy(clock):
    watch = FrozenWatch(ServiceMetrics())
    watched(watch, clock, [7, 7])
    clock.now += PATIENCE
    with pytest.raises(SourceLost, match=r"repeats its last picture .* replug or restart the camera"):
        watch.is_new(picture(7))


def test_a_picture_without_any_return_tells_nothing(clock):
    metrics = ServiceMetrics()
    assert watched(FrozenWatch(metrics), clock, [0] * 100) == [True] * 100
    assert metrics.counts() == {}


def test_the_last_picture_is_known_behind_blank_ones(clock):
    assert watched(FrozenWatch(ServiceMetrics()), clock, [7, 0, 7, 0, 0, 7]) == [True, True, False, True, True, False]


@pytest.mark.parametrize("world", ["paper_room", "open_floor"])
def test_a_simulated_camera_that_stands_still_has_noise_enough(world):
    watch, camera = FrozenWatch(ServiceMetrics()), SimulatedKinect(world)
    assert all(watch.is_new(camera.frame()) for _ in range(100))


@given(st.lists(st.integers(0, 2), max_size=60))
def test_what_passes_is_what_differs_from_the_last_that_showed_something(numbers):
    watch, clock = FrozenWatch(ServiceMetrics()), SimpleNamespace(now=0.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(frozen, "time", SimpleNamespace(monotonic=lambda: clock.now))
        outcomes = watched(watch, clock, numbers)
    last = None
    for number, outcome in zip(numbers, outcomes, strict=True):
        assert (outcome is True) == (number in {0, *{1, 2} - {last}})
        last = number or last
