"""A burst comes through at once, and more than that at a steady rate."""

import pytest

from cliffscan.common.runtime.pace import Pace


def times(pace, count, now=100.0):
    """When each of `count` things that all wait from `now` on comes through."""
    through = []
    for _ in range(count):
        now += pace.delay(now)
        pace.spend(now)
        through.append(now - 100.0)
    return through


def test_a_burst_waits_for_nothing_and_the_rest_for_its_turn():
    assert times(Pace(10.0, 3), 6) == pytest.approx([0.0, 0.0, 0.0, 0.1, 0.2, 0.3])


def test_what_comes_slower_than_the_rate_never_waits():
    pace = Pace(10.0, 1)
    for number in range(20):
        assert pace.delay(0.11 * number) == 0.0
        pace.spend(0.11 * number)


def test_a_rest_saves_up_no_more_than_a_burst():
    pace = Pace(10.0, 2)
    times(pace, 5)
    assert times(pace, 3, now=1000.0)[1:] == pytest.approx([900.0, 900.1])
