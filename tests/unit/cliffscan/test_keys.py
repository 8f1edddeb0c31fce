"""What is typed, as keys and as motions."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.keys import (
    FASTEST,
    FASTEST_TURN,
    FIRST_HOLD,
    REPEAT_HOLD,
    SETTLE,
    STILL,
    KeyPad,
    KeyReader,
    Order,
)

UP, DOWN, RIGHT, LEFT = (b"\x1b[" + letter for letter in (b"A", b"B", b"C", b"D"))


SEQUENCES = [
    *(UP, DOWN, RIGHT, LEFT, b"\x1bOA", b"\x1b[1;5D", b"\x1b[[A", b"\x1b[3~", b"\x1bw", b"\x1b\x1b[B"),
    *(bytes([byte]) for byte in b"wasdWASD +-<>qxcr\x03"),
    "é".encode(),
]
REPEATS = 0.03  # [s] between two repeats of a held key


def keys(*pieces):
    reader = KeyReader()
    return [key for piece in pieces for key in reader.feed(piece)]


def pad(linear=0.2, angular=0.8):
    return KeyPad(linear, angular)


@pytest.mark.parametrize(
    ("typed", "names"),
    [
        (UP + DOWN + RIGHT + LEFT, ["up", "down", "right", "left"]),
        (b"\x1bOA\x1bOD", ["up", "left"]),  # application mode
        (b"\x1b[1;2A\x1b[1;5C", ["up", "right"]),  # with Shift, with Ctrl
        (b"wW", ["w", "w"]),
        (b"\x1b[3~a", ["a"]),  # Delete
        (b"\x1b[[A\x1b[15~", []),  # F1 on Linux's console, F5
        (b"\x1bw", ["w"]),  # Alt and w
        (b"\x1b\x1b[A", ["up"]),  # Escape, then an arrow
        (b"\x1b[1 ", [" "]),
        (b"\x1b\x03", ["\x03"]),
        (b"\x1b[" + b"1;" * 10_000 + b"~w", ["w"]),  # as long as you like
    ],
)
def test_bytes_are_keys(typed, names):
    assert keys(typed) == names


@given(st.lists(st.sampled_from(SEQUENCES)), st.lists(st.integers(0, 200)))
def test_however_the_bytes_are_cut_the_same_keys_come_out(sequences, cuts):
    stream = b"".join(sequences)
    edges = sorted({0, len(stream), *(cut for cut in cuts if cut < len(stream))})
    pieces = [stream[first:last] for first, last in pairwise(edges)]
    assert keys(*pieces) == keys(stream)


@pytest.mark.parametrize(
    ("typed", "motion"),
    [
        (UP, (0.2, 0.0)),
        (DOWN, (-0.2, 0.0)),
        (LEFT, (0.0, 0.8)),
        (RIGHT, (0.0, -0.8)),
        (b"w", (0.2, 0.0)),
        (b"s", (-0.2, 0.0)),
        (b"a", (0.0, 0.8)),
        (b"d", (0.0, -0.8)),
        (UP + LEFT, (0.2, 0.8)),
        (UP + DOWN, (-0.2, 0.0)),
        (UP + b" ", (0.0, 0.0)),
        (UP + b"x", (0.0, 0.0)),
        (UP + b"c", (0.0, 0.0)),
        (UP + b"r", (0.2, 0.0)),
        (UP + b"\x1a", (0.0, 0.0)),
        (b"q" + UP, (0.0, 0.0)),
    ],
)
def test_keys_ask_for_motions(typed, motion):
    driven = pad()
    driven.feed(typed, 0.0)
    assert driven.wanted(0.0) == motion


def test_nothing_is_asked_for_before_the_first_key():
    assert pad().wanted(0.0) is None


def test_a_press_drives_until_repeats_may_begin_then_stands_still_then_leaves_the_robot_to_others():
    driven = pad()
    driven.feed(UP, 10.0)
    assert driven.wanted(10.0 + FIRST_HOLD - 0.001) == (0.2, 0.0)
    assert driven.wanted(10.0 + FIRST_HOLD) == STILL
    assert driven.wanted(10.0 + FIRST_HOLD + SETTLE - 0.001) == STILL
    assert driven.wanted(10.0 + FIRST_HOLD + SETTLE) is None


def test_a_held_key_drives_without_a_gap_and_stops_soon_after_its_release():
    driven = pad()
    driven.feed(UP, 0.0)
    times = [0.45 + REPEATS * turn for turn in range(100)]
    for now in times:
        assert driven.wanted(now) == (0.2, 0.0)
        driven.feed(UP, now)
    assert driven.wanted(times[-1] + REPEAT_HOLD - 0.001) == (0.2, 0.0)
    assert driven.wanted(times[-1] + REPEAT_HOLD) == STILL


def test_a_second_press_is_no_repeat():
    driven = pad()
    driven.feed(UP, 0.0)
    driven.feed(UP, 0.3)
    assert driven.wanted(0.3 + FIRST_HOLD - 0.001) == (0.2, 0.0)


def test_after_a_stop_the_same_key_is_a_press():
    driven = pad()
    driven.feed(UP + b" " + UP, 0.0)
    assert driven.wanted(FIRST_HOLD - 0.001) == (0.2, 0.0)


def test_a_stop_is_said_even_when_nothing_was_driven():
    driven = pad()
    driven.feed(b" ", 5.0)
    assert driven.wanted(5.0) == STILL
    assert driven.wanted(5.0 + SETTLE) is None


@given(st.binary(max_size=40))
def test_a_space_stops_whatever_was_typed_before(typed):
    driven = pad()
    if Order.QUIT not in driven.feed(typed, 0.0):
        driven.feed(b" ", 0.0)
    assert driven.wanted(0.0) == STILL


@given(st.lists(st.tuples(st.sampled_from(SEQUENCES), st.floats(0, 1))))
def test_no_typing_drives_longer_than_a_press_after_its_end_or_faster_than_the_limits(typed):
    driven, now = pad(), 0.0
    for sequence, pause in typed:
        now += pause
        driven.feed(sequence, now)
        motion = driven.wanted(now) or STILL
        assert abs(motion.linear) <= FASTEST
        assert abs(motion.angular) <= FASTEST_TURN
    assert driven.wanted(now + FIRST_HOLD) in (STILL, None)
    assert driven.wanted(now + FIRST_HOLD + SETTLE) is None


@pytest.mark.parametrize(
    ("typed", "speed", "turn_rate"),
    [
        (b"+", 0.25, 0.8),
        (b"=", 0.25, 0.8),
        (b"-", 0.15, 0.8),
        (b">", 0.2, 0.9),
        (b"<", 0.2, 0.7),
        (b".,", 0.2, 0.8),
        (b"+" * 50, FASTEST, 0.8),
        (b"-" * 50, 0.05, 0.8),
        (b">" * 50, 0.2, FASTEST_TURN),
        (b"<" * 50, 0.2, 0.1),
    ],
)
def test_speeds_change_by_steps_within_limits(typed, speed, turn_rate):
    driven = pad()
    driven.feed(typed, 0.0)
    assert (driven.linear, driven.angular) == (speed, turn_rate)


def test_a_low_speed_is_not_raised_by_lowering_it():
    driven = pad(linear=0.03)
    driven.feed(b"-", 0.0)
    assert driven.linear == 0.03


def test_a_new_speed_counts_at_once():
    driven = pad()
    driven.feed(UP + b"+", 0.0)
    assert driven.wanted(0.0) == (0.25, 0.0)


def test_orders_come_in_order_and_none_after_quit():
    assert pad().feed(b"xcr\x03x", 0.0) == [
        Order.EMERGENCY_STOP,
        Order.CLEAR_SAFETY,
        Order.RESET_ODOMETRY,
        Order.QUIT,
    ]
