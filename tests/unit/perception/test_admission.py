"""As many frames are taken as there is time for, of each robot as many; all of them where there is time for all."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.services.perception.admission import FULL, PERIOD, Admission, fair_limit

rates = st.lists(st.floats(0.1, 200.0), min_size=1, max_size=20)


@given(rates, st.floats(1.0, 1000.0))
def test_a_limit_leaves_what_there_is_and_takes_from_the_greediest_alone(offered, capacity):
    limit = fair_limit(offered, capacity)
    taken = [min(rate, limit) for rate in offered]
    if math.isinf(limit):
        assert sum(offered) <= capacity * (1 + 1e-9)
    else:
        assert sum(taken) == pytest.approx(capacity)
        assert max(offered) > limit


def drive(offered, cost, seconds):
    """Frames of each robot at its rate [Hz], worked on in turn; what was taken [Hz] in the end, longest wait [s]."""
    admission, taken, now = Admission(0.0), dict.fromkeys(offered, 0), 0.0
    due, waiting, free = {robot: 1.0 / rate for robot, rate in offered.items()}, [], 0.0
    late = []
    while now < seconds:
        now += 0.001
        for robot, rate in offered.items():
            if due[robot] <= now:
                due[robot] += 1.0 / rate
                if admission.takes(robot, not waiting and free <= now):
                    if any(each[1] == robot for each in waiting):
                        admission.overtaken(robot)
                    waiting = [each for each in waiting if each[1] != robot] + [(now, robot)]
        if waiting and free <= now:
            came, robot = waiting.pop(0)
            free = now + cost[robot]
            admission.worked(robot, cost[robot])
            if now > seconds / 2:
                taken[robot] += 1
                late.append(now - came)
        admission.review(now)
    return admission, {robot: 2 * count / seconds for robot, count in taken.items()}, max(late)


def test_where_there_is_time_every_frame_is_taken():
    offered = {f"r{number}": 10.0 + number for number in range(8)}
    admission, taken, _ = drive(offered, dict.fromkeys(offered, 0.004), 8.0)
    assert admission.shares == {}
    assert taken == pytest.approx(offered, rel=0.1)


def test_a_sender_that_waits_for_each_answer_is_never_limited():
    """It may ask for more than its share beside one that floods, and is never late."""
    admission, now = Admission(0.0), 0.0
    for _ in range(2000):
        now += 0.008
        for robot in ("flood", "waits"):
            assert admission.takes(robot, is_idle=False) or robot == "flood"
            admission.worked(robot, 0.008)
        admission.overtaken("flood")
        admission.review(now)
    assert admission.shares.keys() == {"flood"}


def test_too_many_frames_are_shared_and_none_is_late():
    offered = {f"r{number}": 30.0 for number in range(20)} | {"slow": 5.0}
    admission, taken, late = drive(offered, dict.fromkeys(offered, 0.004), 12.0)
    fair = (FULL / 0.004 - 5.0) / 20
    assert "slow" not in admission.shares
    assert taken.pop("slow") == pytest.approx(5.0, rel=0.15)
    assert list(taken.values()) == pytest.approx([fair] * 20, rel=0.25)
    assert late < 0.1
    assert all(share.offered == pytest.approx(30.0, rel=0.1) for share in admission.shares.values())


def test_a_flood_is_what_is_limited():
    offered = {"flood": 200.0, "a": 30.0, "b": 30.0}
    _, taken, late = drive(offered, dict.fromkeys(offered, 0.008), 8.0)
    assert (taken["a"], taken["b"]) == pytest.approx((30.0, 30.0), rel=0.1)
    assert taken["flood"] == pytest.approx(FULL / 0.008 - 60.0, rel=0.15)
    assert late < 0.1


def test_large_frames_cost_small_ones_nothing():
    offered = {"large": 200.0, "small": 60.0}
    admission, taken, _ = drive(offered, {"large": 0.01, "small": 0.001}, 8.0)
    assert taken["small"] == pytest.approx(60.0, rel=0.1)
    assert taken["large"] == pytest.approx((FULL - 0.06) / 0.01, rel=0.15)
    assert admission.shares.keys() == {"large"}


def test_a_limit_goes_when_there_is_time_again():
    admission = Admission(0.0)
    for _ in range(100):
        admission.takes("a", False)
        admission.worked("a", PERIOD / 50)
    admission.overtaken("a")
    assert admission.review(PERIOD)
    assert admission.shares
    assert admission.takes("a", True)
    assert not admission.takes("a", False)
    admission.worked("a", 0.01)
    assert not admission.review(1.5 * PERIOD)
    assert admission.review(2 * PERIOD)
    assert admission.shares == {}
