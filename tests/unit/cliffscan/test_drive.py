"""Driving by keys: what bytes and times ask for, what is shown, and that the wheels are always told to stand still."""

import os
import termios
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.dashboard import Aged, Line, View, lines, screen
from cliffscan.drive import PERIOD, Terminal, Wheels, drive
from cliffscan.keys import (
    FASTEST,
    FASTEST_TURN,
    FIRST_HOLD,
    REPEAT_HOLD,
    SETTLE,
    STILL,
    KeyPad,
    KeyReader,
    Motion,
    Order,
)
from common.base_messages import BaseState, Odometry, SafetyState

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


class Said:
    """A publisher that remembers."""

    def __init__(self) -> None:
        self.motions = []

    def put(self, message):
        assert message.stamp > 0
        self.motions.append((message.linear, message.angular))


def test_a_change_is_said_at_once_and_a_motion_again_every_period():
    said = Said()
    wheels = Wheels(said)
    forward = Motion(0.2, 0.0)
    for motion, now in (
        (None, 0.0),
        (forward, 0.01),
        (forward, 0.02),
        (forward, 0.01 + PERIOD),
        (STILL, 0.07),
        (None, 0.08),
        (None, 1.0),
    ):
        wheels.turn(motion, now)
    assert said.motions == [(0.2, 0.0), (0.2, 0.0), (0.0, 0.0)]
    assert wheels.due == 1.0 + PERIOD


def test_whatever_fails_the_wheels_are_told_to_stand_still():
    said = Said()

    def fail():
        with Wheels(said) as wheels:
            wheels.turn(Motion(0.2, 0.0), 1.0)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert said.motions[0] == (0.2, 0.0)
    assert set(said.motions[1:]) == {(0.0, 0.0)}


@pytest.fixture
def pty():
    master, slave = os.openpty()
    yield master, slave
    os.close(slave)
    os.close(master)


def test_a_terminal_is_put_back_whatever_fails(pty):
    master, slave = pty
    before = termios.tcgetattr(slave)

    def fail():
        with Terminal(slave) as terminal:
            assert termios.tcgetattr(slave) != before
            os.write(master, b"\x03\r")  # neither a signal nor a line feed
            assert terminal.read(5.0) == b"\x03\r"
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert termios.tcgetattr(slave) == before


def test_what_was_typed_before_or_after_is_not_read(pty):
    master, slave = pty
    os.write(master, b"before\n")
    with Terminal(slave) as terminal:
        assert terminal.read(0.0) == b""
        os.write(master, b"after\n")
    os.set_blocking(slave, False)
    with pytest.raises(BlockingIOError):
        os.read(slave, 100)


def test_a_terminal_that_takes_nothing_blocks_nobody(pty):
    _, slave = pty
    with Terminal(slave) as terminal:
        for _ in range(20):
            terminal.draw(b"x" * 10_000)
        assert terminal.read(0.0) == b""


def test_a_terminal_without_a_size_has_the_usual_one(pty):
    with Terminal(pty[1]) as terminal:
        assert terminal.size() == (80, 24)


@pytest.mark.parametrize(
    ("linear", "angular", "told"),
    [(0.2, 0.8, "no terminal"), (0.0, 0.8, "linear 0"), (0.8, 0.8, "0.7 m/s"), (0.2, float("nan"), "angular nan")],
)
def test_what_cannot_drive_is_told_on_one_line(monkeypatch, capsys, linear, angular, told):
    monkeypatch.setattr(os, "isatty", lambda _: "terminal" not in told)
    assert drive(None, None, linear, angular) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


STATE = BaseState(
    stamp=1,
    bumpers=(False, False, False),
    cliffs=(False, False, False),
    cliff_counts=(0, 0, 0),
    wheel_drops=(False, False),
    overcurrents=(False, False),
    currents=(0.0, 0.0),
    buttons=(False, False, False),
    battery_voltage=16.14,
    battery_percent=87.4,
    charger="dock_charging",
    dock_ir=(0, 0, 0),
    digital_inputs=(False, False, False, False),
    analog_inputs=(0.0, 0.0, 0.0, 0.0),
)
ODOMETRY = Odometry(
    stamp=1,
    frame="odom",
    child_frame="base_link",
    pose=(1.2345, -0.5, 1.5707963),
    twist=(0.18, -0.25),
    pose_covariance=[0.0] * 9,
    twist_covariance=[0.0] * 9,
)


def safety(**changes):
    fields = {"rule": "free", "distance": -1.0, "asked": (0.2, 0.0), "allowed": (0.2, 0.0), "latched": False}
    return SafetyState(**({"stamp": 1, "note": ""} | fields | changes))


def view(**changes):
    return View(**({"robot": "turtlebot", "speed": 0.2, "turn_rate": 0.8} | changes))


def line(begin, **changes):
    found = [each for each in lines(view(**changes)) if each.text.strip().startswith(begin)]
    assert len(found) == 1
    return found[0]


def test_the_battery_is_shown_with_its_age():
    assert line("battery", state=Aged(STATE, 0.04)) == Line("battery   16.1 V   87 %   dock_charging   (0.0 s old)")


def test_the_odometry_is_shown():
    heard = Aged(ODOMETRY, 0.1)
    assert line("pose", odometry=heard).text.startswith("pose      x +1.234 m   y -0.500 m   heading +90.0 deg")
    assert line("moves", odometry=heard).text.startswith("moves     +0.18 m/s   -0.25 rad/s")


@pytest.mark.parametrize("begin", ["battery", "pose", "moves", "gate"])
def test_what_was_never_heard_is_said(begin):
    assert line(begin) == Line(f"{begin:10}nothing heard yet", alarm=True)


def test_what_is_stale_is_said():
    assert line("battery", state=Aged(STATE, 3.21)) == Line(
        "battery   16.1 V   87 %   dock_charging   (STALE, 3.2 s old)", alarm=True
    )
    assert line("pose", odometry=Aged(ODOMETRY, 0.6)).alarm
    assert not line("gate", safety=Aged(safety(), 1.2)).alarm
    assert "STALE" in line("gate", safety=Aged(safety(), 2.6)).text


def test_a_free_way_is_no_alarm():
    heard = Aged(safety(), 0.2)
    assert line("gate", safety=heard) == Line("gate      free   (0.2 s old)")
    assert line("asked", safety=heard) == Line("  asked   +0.20 m/s   +0.00 rad/s")
    assert line("allowed", safety=heard) == Line("  allowed +0.20 m/s   +0.00 rad/s")


def test_to_stand_without_a_command_is_no_alarm():
    assert not line("gate", safety=Aged(safety(rule="no_command", asked=(0.0, 0.0), allowed=(0.0, 0.0)), 0.0)).alarm


def test_what_the_gate_does_is_shown():
    heard = Aged(safety(rule="obstacle", distance=0.62, allowed=(0.07, 0.0), note="drop ahead"), 0.0)
    assert line("gate", safety=heard) == Line("gate      obstacle at 0.62 m: drop ahead   (0.0 s old)", alarm=True)
    assert line("allowed", safety=heard) == Line("  allowed +0.07 m/s   +0.00 rad/s", alarm=True)


def test_a_latch_is_shown_with_its_key():
    assert (
        "stopped, holds until c is pressed" in line("gate", safety=Aged(safety(rule="stopped", latched=True), 0)).text
    )


def test_what_is_wanted_and_how_fast_is_shown():
    assert line("turtlebot").text == "turtlebot: not driving"
    assert line("turtlebot", wanted=Motion(0.2, -0.8)).text == "turtlebot: +0.20 m/s   -0.80 rad/s"
    assert line("speed").text == "speed     0.20 m/s   turn rate 0.80 rad/s"


def test_every_key_is_explained():
    text = " ".join(each.text for each in lines(view()))
    for word in ("arrows", "space", "+ -", "< >", "x  emergency", "c  clear", "r  reset", "q  quit"):
        assert word in text


@given(st.text(max_size=50))
def test_no_text_of_others_reaches_the_terminal_as_a_command(text):
    shown = lines(view(note=text, safety=Aged(safety(note=text), 0.0), state=Aged(STATE, 0.0)))
    assert all(each.text.isprintable() for each in shown)
    picture = screen(shown, 200, 50).replace(b"\r\n", b"")
    for ours in (b"\x1b[0m", b"\x1b[7m", b"\x1b[H", b"\x1b[K", b"\x1b[J"):
        picture = picture.replace(ours, b"")
    assert all(0x20 <= byte < 0x7F for byte in picture)


def test_a_screen_has_the_lines_that_fit_and_nothing_else():
    shown = [Line("abcdef"), Line("ghi", alarm=True), Line("not this")]
    assert screen(shown, 4, 2) == b"\x1b[0m\x1b[Habcd\x1b[K\r\n\x1b[7mghi\x1b[0m\x1b[K\x1b[J"
