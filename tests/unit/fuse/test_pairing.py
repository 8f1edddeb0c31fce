"""Scans of one frame find each other; one that lacks its partner waits, and is given up."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.services.fuse.pairing import ROOM, Pairing
from tests import build

SIDES = ("positive", "negative")


def scan(stamp, seq=0, nearest=1.0):
    return build.scan([nearest, 2.0], stamp=stamp, seq=seq)


@pytest.fixture
def pairing():
    return Pairing(timeout=0.5)


@pytest.mark.parametrize("sides", [SIDES, SIDES[::-1]])
def test_scans_of_one_frame_are_a_pair_whichever_comes_first(pairing, sides):
    scans = {side: scan(7) for side in SIDES}
    assert pairing.add(sides[0], scans[sides[0]], 0.0) is None
    pair = pairing.add(sides[1], scans[sides[1]], 0.1)
    assert pair.positive is scans["positive"]
    assert pair.negative is scans["negative"]


@pytest.mark.parametrize("other", [6, 8, 7 + 10**9])
def test_scans_of_other_stamps_are_none_however_near(pairing, other):
    assert pairing.add("positive", scan(7), 0.0) is None
    assert pairing.add("negative", scan(other), 0.0) is None


@pytest.mark.parametrize("sides", [SIDES, SIDES[::-1]])
def test_scans_of_two_frames_of_one_stamp_are_none(pairing, sides):
    first, second = sides
    for seq in (1, 2):
        assert pairing.add(first, scan(7, seq), 0.0) is None
    for seq in (1, 2):
        pair = pairing.add(second, scan(7, seq), 0.1)
        assert (pair.positive.seq, pair.negative.seq) == (seq, seq)


def test_a_pair_is_made_once(pairing):
    pairing.add("positive", scan(7), 0.0)
    assert pairing.add("negative", scan(7), 0.0)
    assert pairing.add("negative", scan(7), 0.0) is None
    assert pairing.drop_late(0.5) == ["stamp 7: only negative came"]


def test_of_a_repeated_scan_the_newest_counts(pairing):
    pairing.add("positive", scan(7, nearest=1.0), 0.0)
    assert pairing.add("positive", scan(7, nearest=0.5), 0.0) is None
    assert pairing.add("negative", scan(7), 0.0).positive.ranges[0] == 0.5


def test_frames_may_overtake_each_other(pairing):
    for stamp in (1, 2, 3):
        pairing.add("positive", scan(stamp), 0.0)
    assert [pairing.add("negative", scan(stamp), 0.0).positive.stamp for stamp in (3, 1, 2)] == [3, 1, 2]
    assert pairing.drop_late(9.0) == []


def test_a_scan_is_given_up_after_the_timeout_and_no_sooner(pairing):
    pairing.add("positive", scan(7), 10.0)
    assert pairing.drop_late(10.49) == []
    assert pairing.drop_late(10.5) == ["stamp 7: only positive came"]
    assert pairing.drop_late(99.0) == []


def test_a_partner_that_comes_too_late_waits_in_vain(pairing):
    pairing.add("positive", scan(7), 0.0)
    pairing.drop_late(0.5)
    assert pairing.add("negative", scan(7), 0.6) is None
    assert pairing.drop_late(1.1) == ["stamp 7: only negative came"]


def test_a_repeated_scan_does_not_prolong_the_wait(pairing):
    pairing.add("positive", scan(7), 0.0)
    pairing.add("positive", scan(7), 0.4)
    assert pairing.drop_late(0.5) == ["stamp 7: only positive came"]


def test_of_too_many_frames_the_oldest_are_given_up(pairing):
    for stamp in range(ROOM + 3):
        pairing.add("positive", scan(stamp), 0.0)
    assert pairing.drop_late(0.0) == [f"stamp {stamp}: only positive came" for stamp in range(3)]
    assert pairing.add("negative", scan(2), 0.0) is None
    assert pairing.add("negative", scan(3), 0.0)


def test_late_and_too_many_at_once_are_told_once_each(pairing):
    for stamp in range(ROOM + 3):
        pairing.add("negative", scan(stamp), 0.0)
    assert len(pairing.drop_late(1.0)) == ROOM + 3


@given(st.lists(st.tuples(st.sampled_from(SIDES), st.integers(0, 4), st.floats(0, 0.3)), max_size=40))
def test_no_scan_is_in_two_pairs_and_none_is_forgotten(arrivals):
    pairing, now, waiting = Pairing(timeout=0.5), 0.0, {}
    for side, stamp, later in arrivals:
        now += later
        dropped = {stamp for stamp, (since, _) in waiting.items() if now - since >= 0.5}
        assert len(pairing.drop_late(now)) == len(dropped)
        waiting = {stamp: value for stamp, value in waiting.items() if stamp not in dropped}
        _, sides = waiting.setdefault(stamp, (now, set()))
        sides.add(side)
        pair = pairing.add(side, scan(stamp), now)
        assert bool(pair) == (len(sides) == 2)
        if pair:
            assert pair.positive.stamp == pair.negative.stamp == stamp
            del waiting[stamp]
