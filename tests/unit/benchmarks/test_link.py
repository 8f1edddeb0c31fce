"""What an emulated link does to packets, and what is counted of a drive over it."""

import random

import numpy as np
import pytest

from benchmarks.link.figures import figures, share_of
from benchmarks.link.path import Link, Path

SECOND = 1_000_000_000  # [ns]


def path(**changes):
    return Path(Link(8e6)._replace(**changes), random.Random(1))


def test_packets_take_the_link_one_after_another():
    one = path(delay=0.01)
    assert [one.arrival(1000, 5.0) for _ in range(3)] == pytest.approx([5.011, 5.012, 5.013])
    assert one.arrival(1000, 6.0) == pytest.approx(6.011)
    assert (one.carried, one.lost) == (4000, 0)


def test_what_would_wait_longer_than_the_queue_is_dropped():
    one = path(queue=0.0025)
    assert [one.arrival(1000, 0.0) is None for _ in range(5)] == [False, False, False, True, True]
    assert one.arrival(1000, 0.002) == pytest.approx(0.004)


def test_jitter_never_reorders():
    one = path(delay=0.01, jitter=0.009)
    arrivals = [one.arrival(100, 0.001 * number) for number in range(500)]
    assert arrivals == sorted(arrivals)
    late = np.array(arrivals) - 0.001 * np.arange(500)
    assert 0.001 < late.min() < late.max() < 0.03


def test_a_share_is_lost_and_takes_its_time_all_the_same():
    one = path(loss=0.1, queue=1e9)
    arrivals = [one.arrival(1000, 0.0) for _ in range(2000)]
    lost = sum(each is None for each in arrivals)
    assert lost == one.lost
    assert 150 < lost < 250
    assert one.arrival(1000, 0.0) == pytest.approx(2.001)


def test_nothing_gets_through_a_link_that_is_down():
    one = path()
    one.down = True
    assert one.arrival(1000, 0.0) is None
    one.down = False
    assert one.arrival(1000, 0.0) is not None


def test_figures_are_of_what_arrived_in_time():
    fused = [(at - SECOND // 10, at) for at in range(SECOND, 11 * SECOND, SECOND // 20)]
    odometry = [(at, at) for at in range(0, 12 * SECOND, SECOND // 50)]
    arrived = [(stamp, at + SECOND // 4) for stamp, at in odometry[::2]]
    robot = {
        "scan/fused": [*fused, fused[-1]],
        "base/odom": odometry,
        "base/safety": [(0, "clear"), (9 * SECOND, "no_scan")],
    }
    found = figures(robot, {"base/odom": arrived}, SECOND, 11 * SECOND, 5000)
    assert found.rate == pytest.approx(20.1)
    assert (found.median, found.percentile99) == (pytest.approx(0.1), pytest.approx(0.1))
    assert found.gap == pytest.approx(0.05)
    assert found.no_scan == pytest.approx(0.2)
    assert found.odometry_lost == pytest.approx(0.5)
    assert found.odometry_late == pytest.approx(0.25)
    assert (found.doubled, found.up) == (1, 500)


def test_a_rule_holds_until_the_next_one():
    rules = [(2, "no_scan"), (4, "clear"), (7, "no_scan")]
    assert share_of(rules, "no_scan", 3, 11) == pytest.approx(5 / 8)
    assert share_of([], "no_scan", 0, 1) == 0
