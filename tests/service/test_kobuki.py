"""kobuki against the emulated firmware on a pty: commands, sensors, faults, and the last word."""

import signal
import sys
import time

import numpy as np
import pytest

from simulator.kobuki.client import Remote
from tests.service.conftest import scan


class Base:
    """An emulated base and the service that drives it."""

    def __init__(self, client, folder) -> None:
        self.client = client
        self.link, self.control = folder / "kobuki", folder / "control"
        self.remote = None
        self.service = None
        self.safety = client.listen("base/safety")
        self.state = client.listen("base/state")
        self.odometry = client.listen("base/odom")
        self.seq = 0

    def ask(self, name, **parameters):
        return self.client.ask(f"base/command/{name}", parameters)

    def drive(self, linear, angular=0.0):
        stamp = time.time_ns()
        self.client.put("base/cmd_vel", {"stamp": stamp, "linear": linear, "angular": angular})

    def see(self, *ranges, age=0.0):
        """A fused scan of ten beams a value."""
        self.seq += 1
        stamp = time.time_ns() - int(age * 1e9)
        values = np.repeat(ranges or (4.0,), 10)
        self.client.put("scan/fused", scan(values, stamp, seq=self.seq))

    def until(self, rule, *, linear=None, angular=0.0, ranges=(4.0,)):
        """Drive on, seeing `ranges`, until the gate says `rule`."""
        while True:
            if linear is not None:
                self.see(*ranges)
                self.drive(linear, angular)
            told = self.safety.get_within(0.05)
            if told and told["rule"] == rule:
                return told

    def moves(self):
        return self.remote.state()["target"]


@pytest.fixture
def base(client, run, start, tmp_path):
    made = Base(client, tmp_path)
    emulator = run([sys.executable, "-m", "simulator.kobuki", "--link", str(made.link), "--control", str(made.control)])
    emulator.wait_said("ready")
    made.remote = Remote(made.control)
    made.service = start("kobuki", "--set", f"kobuki.port={made.link}")
    return made


def test_it_drives_where_it_is_told_and_says_where_it_is(base):
    base.until("free", linear=0.2)
    while base.odometry.get()["pose"][0] < 0.1:
        base.see()
        base.drive(0.2)
    assert base.remote.state()["truth"]["x"] > 0.05
    base.until("no_command")
    while any(base.moves().values()):
        pass


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
    while any(base.moves().values()):
        pass
    assert 0.4 < base.remote.state()["truth"]["x"] < wall - 0.18


def test_a_cliff_makes_it_back_off_and_then_keep_away(base):
    base.until("free", linear=0.2)
    base.remote.tell("cliff left on")
    told = base.until("cliff", linear=0.2)
    assert told["allowed"] == [-0.1, -0.4]
    while base.moves()["left"] >= 0.0:
        pass
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


def test_garbage_and_cuts_do_not_matter(base):
    base.remote.tell("cut 7")
    base.remote.tell("garbage 1000")
    base.until("free", linear=0.2)


def test_unplugged_and_plugged_in_again_it_goes_on_where_it_was(base):
    base.until("free", linear=0.2)
    before = base.odometry.get()["pose"]
    base.remote.tell("unplug 0.3")
    base.service.wait_said("port_lost")
    base.until("no_base")
    base.until("free", linear=0.2)
    base.odometry.all()
    after = base.odometry.get()["pose"]
    assert np.hypot(after[0] - before[0], after[1] - before[1]) < 0.5


def test_after_a_pause_it_drives_on_from_where_it_came_to_rest(base):
    """It rolls on until the guard stops it; what it then knows to be free is around it, not where it was before."""
    while base.odometry.get()["pose"][0] < 0.3:
        base.see()
        base.drive(0.5)
    base.service.signal(signal.SIGSTOP)
    stopped = base.remote.state()
    while (resting := base.remote.state())["time"] < stopped["time"] + 1.3:
        pass
    rest = resting["truth"]["x"]
    assert not any(resting["speeds"].values())
    assert rest > stopped["truth"]["x"] + 0.2
    base.service.signal(signal.SIGCONT)
    base.service.wait_said("s between two packets")
    base.odometry.until(lambda each: each["pose"][0] > rest - 0.03)  # a scan that came before would show more
    for _ in range(200):  # some ten seconds
        base.see(*[4.0] * 64)  # with no beam half an increment beyond the view
        base.drive(0.5)
        base.safety.get_within(0.05)
        if base.remote.state()["truth"]["x"] > rest + 0.5:
            return
    pytest.fail("it does not drive on")


def test_a_power_cycle_makes_no_jump(base):
    poses = [base.odometry.get()["pose"] for _ in range(5)]
    base.remote.tell("power_cycle")
    base.service.wait_said("baseline (2 so far)")
    poses += [base.odometry.get()["pose"] for _ in range(20)]
    assert np.abs(np.diff(poses, axis=0)).max() < 0.02


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP, signal.SIGTERM])
def test_the_last_word_is_stop(base, number):
    base.until("free", linear=0.3)
    while not base.moves()["left"] > 0.0:
        base.see()
        base.drive(0.3)
    watch = base.remote.watch()
    base.service.process.send_signal(number)
    stopped = next(event for event in watch if event.get("command") == "base_control" and event["speed"] == 0)
    assert stopped
    if number == signal.SIGSTOP:
        base.service.process.send_signal(signal.SIGCONT)
    base.service.expected = -signal.SIGKILL if number == signal.SIGKILL else 0


@pytest.mark.parametrize(("version", "why"), [("0.9.0", "older than 1.0.0"), ("2.0.0", "upgrade the software")])
def test_another_firmware_is_refused_and_never_driven(client, run, start, tmp_path, version, why):
    link, control = tmp_path / "kobuki", tmp_path / "control"
    command = [sys.executable, "-m", "simulator.kobuki", "--link", str(link), "--control", str(control)]
    run([*command, "--firmware", version]).wait_said("ready")
    service = start("kobuki", "--set", f"kobuki.port={link}", wait=False)
    service.wait_said(why)
    ear = client.listen("base/safety")
    client.put("base/cmd_vel", {"stamp": time.time_ns(), "linear": 0.2, "angular": 0.0})
    told = ear.until(lambda each: each["rule"] == "refused")
    assert told["allowed"] == [0.0, 0.0]
    assert "base_control" not in Remote(control).state()["received"]


def test_a_port_that_is_not_there_says_so_with_the_remedy(client, start, tmp_path):
    safety = client.listen("base/safety")
    service = start("kobuki", "--set", f"kobuki.port={tmp_path}/none", wait=False)
    service.wait_said("no such device: plug the base in")
    assert [safety.get()["rule"] for _ in range(2)] == ["no_base"] * 2
