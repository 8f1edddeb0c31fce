"""kobuki against the emulated firmware: commands, sensors, and the gate between them."""

import numpy as np
import pytest

from tests.service.conftest import wait_until


def test_it_drives_where_it_is_told_and_says_where_it_is(base):
    base.until("free", linear=0.2)
    while base.odometry.get()["pose"][0] < 0.1:
        base.see()
        base.drive(0.2)
    assert base.remote.state()["truth"]["x"] > 0.05
    base.until("no_command")
    base.wait_at_rest()


def test_without_a_scan_it_only_turns(base):
    base.drive(0.2, 3.0)
    told = base.safety.until(lambda each: each["rule"] == "no_scan")
    assert told["allowed"][0] == 0.0
    assert 0.0 <= told["allowed"][1] <= np.radians(30) + 1e-9


def test_a_scan_that_is_old_is_none(base):
    base.until("free", linear=0.2)
    while True:
        base.see(age=1.0)
        base.drive(0.2)
        told = base.safety.get_within(0.05)
        if told and told["rule"] == "no_scan":
            break


def test_an_obstacle_ahead_stops_it_before(base):
    wall, told = 1.3, {"allowed": [1.0], "rule": "free"}
    while told["rule"] != "obstacle" or told["allowed"][0] > 0.01:
        base.see(wall - base.remote.state()["truth"]["x"] + 0.087)  # the camera looks from behind
        base.drive(0.3)
        told = base.safety.get_within(0.05) or told
    base.wait_at_rest()
    assert 0.4 < base.remote.state()["truth"]["x"] < wall - 0.18


def test_a_cliff_makes_it_back_off_and_then_keep_away(base):
    base.until("free", linear=0.2)
    base.remote.tell("cliff left on")
    told = base.until("cliff", linear=0.2)
    assert told["allowed"] == [-0.1, -0.4]
    wait_until(lambda: base.moves()["left"] < 0.0)
    base.remote.tell("cliff left off")
    told = base.until("obstacle", linear=0.2)
    assert told["distance"] < 0.15
    base.until("free", linear=-0.1)


def test_a_wheel_drop_stops_it(base):
    base.until("free", linear=0.2)
    base.remote.tell("wheel_drop right on")
    assert base.until("wheel_drop", linear=0.2)["allowed"] == [0.0, 0.0]
    base.remote.tell("wheel_drop right off")
    base.until("free", linear=0.2)


def test_the_emergency_stop_holds_until_it_is_cleared(base):
    base.until("free", linear=0.2)
    assert base.ask("stop")["ok"]
    told = base.until("stopped", linear=0.2)
    assert (told["latched"], told["allowed"]) == (True, [0.0, 0.0])
    assert base.ask("clear_safety")["ok"]
    base.until("free", linear=0.2)
    base.remote.tell("button 0 press")
    base.until("stopped", linear=0.2)


def test_requests_are_done_or_say_why_not(base):
    assert base.ask("version")["firmware"] == "1.2.0"
    assert base.ask("led", led=1, colour="green")["ok"]
    for led in (3, True):
        refused = base.ask("led", led=led, colour="green")
        assert (refused["ok"], "led" in refused["message"]) == (False, True)
    assert base.ask("stop", colour="nobody knows")["ok"]
    assert base.ask("clear_safety")["ok"]
    assert base.ask("digital_output", supply="5V", on=False)["ok"]
    assert base.ask("gains")["p"] == pytest.approx(100.0)
    assert base.ask("gains", p=90.0, i=0.2, d=1.0)["p"] == pytest.approx(90.0)
    assert base.ask("sound", frequency=1e9, duration=0.1)["ok"] is False
    assert base.ask("sound", sequence="on")["ok"]
    assert base.ask("reset_odometry")["ok"]
    output = base.remote.state()["output"]
    assert output["leds"] == ["green", "off"]
    assert output["supplies"] == {"3.3V": True, "5V": False, "12V5A": True, "12V1.5A": True}


@pytest.mark.parametrize("name", ["dance", "*"])
def test_who_asks_for_no_command_is_told_which_there_are(base, name):
    answer = base.ask(name)
    assert answer["ok"] is False
    assert answer["message"].startswith("no such command; there are stop, clear_safety, reset_odometry, led")
    assert base.ask("version")["ok"]
    base.until("no_command")


def test_sensors_are_told(base):
    base.remote.tell("bumper right on")
    base.remote.tell("battery 14.0")
    told = base.state.until(lambda each: each["bumpers"] == [False, False, True])
    told = base.state.until(lambda each: each["battery_voltage"] == pytest.approx(14.0))
    assert 0 < told["battery_percent"] < 100
    imu = base.client.listen("base/imu").get()
    assert len(imu["angular_velocities"]) == 4 * 3 * len(imu["sample_stamps"])
