"""One source drives at a time, and no command of another time moves anything."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.safety.command_arbiter import REMEMBERED, CommandArbiter

STAMP = 1_700_000_000_000_000_000  # [ns] on our clock at 0 s
TIMEOUT, TOLERANCE = 0.3, 0.5


def stamp(now):
    return STAMP + round(now * 1e9)


def command(now, source="", priority=0, late=0.0):
    return Velocity(stamp=stamp(now - late), linear=0.3, angular=0.0, source=source, priority=priority)


@pytest.fixture
def arbiter():
    return CommandArbiter(TIMEOUT, TOLERANCE)


def offer(arbiter, now, *args, **kwargs):
    return arbiter.offer(command(now, *args, **kwargs), stamp(now), now)


@pytest.mark.parametrize("late", [-0.49, 0.0, 0.49])
def test_a_stamp_that_is_about_ours_is_taken(arbiter, late):
    assert not offer(arbiter, 10.0, late=late)


@pytest.mark.parametrize(
    ("late", "words"),
    [(10.0, "10.0 s behind this clock"), (-3600.0, "3600.0 s ahead of this clock"), (0.51, "0.5 s behind")],
)
def test_another_stamp_moves_nothing_and_it_is_told_by_how_much(arbiter, late, words):
    refusal = offer(arbiter, 10.0, "nav", late=late)
    assert words in refusal
    assert "'nav'" in refusal
    assert "synchronise" in refusal
    assert arbiter.note(10.5) == refusal
    assert not arbiter.note(10.1 + REMEMBERED)


def test_a_stamp_of_nought_moves_nothing(arbiter):
    assert arbiter.offer(Velocity(stamp=0, linear=0.3, angular=0.0), stamp(1.0), 1.0)


def test_another_source_waits_until_the_first_is_silent(arbiter):
    assert not offer(arbiter, 0.0, "a")
    assert "'a' drives with priority 0" in offer(arbiter, 0.2, "b")
    assert not offer(arbiter, 0.25, "a")
    assert offer(arbiter, 0.5, "b")
    assert not offer(arbiter, 0.6, "b")
    assert offer(arbiter, 0.7, "a")


def test_a_higher_priority_takes_over_at_once_and_a_lower_one_waits(arbiter):
    assert not offer(arbiter, 0.0, "nav")
    assert not offer(arbiter, 0.01, "person", 10)
    assert offer(arbiter, 0.02, "nav")
    assert offer(arbiter, 0.30, "nav")
    assert not offer(arbiter, 0.32, "nav")


def test_of_one_source_the_newest_counts(arbiter):
    assert not offer(arbiter, 0.0, "a")
    assert "overtaken" in offer(arbiter, 0.05, "a", late=0.2)
    assert not offer(arbiter, 0.06, "a")


def test_a_refused_command_does_not_keep_the_wheels(arbiter):
    assert not offer(arbiter, 0.0, "a")
    assert offer(arbiter, 0.25, "a", late=2.0)
    assert not offer(arbiter, 0.35, "b")


def test_a_name_of_control_characters_reaches_no_terminal(arbiter):
    assert not offer(arbiter, 0.0, "\x1b[2J" + "x" * 200)
    refusal = offer(arbiter, 0.0, "b")
    assert "\x1b" not in refusal
    assert len(refusal) < 200


@given(st.lists(st.tuples(st.floats(0.0, 0.2), st.sampled_from("abc"), st.integers(-2, 2)), max_size=40))
@settings(max_examples=200)
def test_the_wheels_change_hands_only_upwards_or_after_silence(steps):
    arbiter, now, holder = CommandArbiter(TIMEOUT, TOLERANCE), 0.0, None
    for wait, source, priority in steps:
        now += wait
        if offer(arbiter, now, source, priority):
            continue
        if holder and holder[0] != source:
            assert priority > holder[1] or now - holder[2] > TIMEOUT
        holder = (source, priority, now)
