"""What the driver is shown."""

import re
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.contract.base_messages import BaseState, Odometry, Rule, SafetyState
from cliffscan.dashboard import ORDINARY, Aged, Line, View, lines, screen
from cliffscan.keys import (
    Motion,
)

UP, DOWN, RIGHT, LEFT = (b"\x1b[" + letter for letter in (b"A", b"B", b"C", b"D"))


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
    received = Aged(ODOMETRY, 0.1)
    assert line("pose", odometry=received).text.startswith("pose      x +1.234 m   y -0.500 m   heading +90.0 deg")
    assert line("moves", odometry=received).text.startswith("moves     +0.18 m/s   -0.25 rad/s")


@pytest.mark.parametrize("begin", ["battery", "pose", "moves", "gate"])
def test_what_was_never_received_is_shown(begin):
    assert line(begin) == Line(f"{begin:10}nothing received yet", alarm=True)


def test_what_is_stale_is_said():
    assert line("battery", state=Aged(STATE, 3.21)) == Line(
        "battery   16.1 V   87 %   dock_charging   (STALE, 3.2 s old)", alarm=True
    )
    assert line("pose", odometry=Aged(ODOMETRY, 0.6)).alarm
    assert not line("gate", safety=Aged(safety(), 1.2)).alarm
    assert "STALE" in line("gate", safety=Aged(safety(), 2.6)).text


def test_a_free_way_is_no_alarm():
    received = Aged(safety(), 0.2)
    assert line("gate", safety=received) == Line("gate      free   (0.2 s old)")
    assert line("asked", safety=received) == Line("  asked   +0.20 m/s   +0.00 rad/s")
    assert line("allowed", safety=received) == Line("  allowed +0.20 m/s   +0.00 rad/s")


def test_to_stand_without_a_command_is_no_alarm():
    assert not line("gate", safety=Aged(safety(rule="no_command", asked=(0.0, 0.0), allowed=(0.0, 0.0)), 0.0)).alarm


def test_what_the_gate_does_is_shown():
    received = Aged(safety(rule="obstacle", distance=0.62, allowed=(0.07, 0.0), note="drop ahead"), 0.0)
    assert line("gate", safety=received) == Line("gate      obstacle, 0.62 m to go   (0.0 s old)", alarm=True)
    assert line("drop", safety=received) == Line("  drop ahead", alarm=True)
    assert line("allowed", safety=received) == Line("  allowed +0.07 m/s   +0.00 rad/s", alarm=True)


@pytest.mark.parametrize("rule", [rule for rule in get_args(Rule) if rule not in ORDINARY])
def test_a_rule_without_a_note_is_told_in_words(rule):
    texts = [each.text for each in lines(view(safety=Aged(safety(rule=rule), 0.0)))]
    gate = next(index for index, text in enumerate(texts) if text.startswith(f"gate      {rule}"))
    assert re.fullmatch(r"  [a-z' ]{10,}[^+]*", texts[gate + 1]), texts[gate + 1]


def test_an_obstacle_without_a_note_may_be_an_edge():
    assert "an edge" in line("an obstacle", safety=Aged(safety(rule="obstacle", distance=0.0), 0.0)).text


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
