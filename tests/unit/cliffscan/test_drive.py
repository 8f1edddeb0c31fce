"""Driving by keyboard: what is said, and the terminal that is put back."""

import os
import termios

import pytest

from cliffscan.drive import PERIOD, Terminal, Wheels, drive
from cliffscan.keys import (
    STILL,
    Motion,
)

UP, DOWN, RIGHT, LEFT = (b"\x1b[" + letter for letter in (b"A", b"B", b"C", b"D"))


class Said:
    """A publisher that remembers."""

    def __init__(self) -> None:
        self.motions = []

    def put(self, message):
        assert message.stamp > 0
        assert (message.source, message.priority) == ("drive", 10)  # a person at the keys outranks a program
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
