"""kobuki when the line, the base or the service itself fails, and the last word."""

import signal
import sys
import time

import numpy as np
import pytest

from cliffscan.simulator.kobuki.client import Remote
from tests.service.conftest import DEADLINE, wait_until


def test_garbage_and_cuts_do_not_matter(base):
    base.remote.tell("cut 7")
    base.remote.tell("garbage 1000")
    base.until("free", linear=0.2)


def test_unplugged_and_plugged_in_again_it_goes_on_where_it_was(base):
    base.until("free", linear=0.2)
    before = base.odometry.get()["pose"][0]
    base.remote.tell("unplug 0.3")
    base.service.wait_said("port_lost")
    base.until("no_base")
    base.until("free", linear=0.0, angular=0.5)  # ahead it may have come to the end of what was free around its start
    base.until("no_command")
    base.wait_at_rest()
    base.odometry.all()
    after = base.odometry.get()["pose"][0]
    assert before <= after < base.remote.state()["truth"]["x"] + 0.05  # what it drove meanwhile is not known


def test_after_a_pause_it_drives_on_from_where_it_came_to_rest(base):
    """It rolls on until the guard stops it; what it then knows to be free is around it, not where it was before."""
    while base.odometry.get()["pose"][0] < 0.3:
        base.see()
        base.drive(0.5)
    began = base.remote.state()
    base.service.signal(signal.SIGSTOP)

    def rests():
        state = base.remote.state()
        return state["time"] > began["time"] + 1.3 and not any(state["speeds"].values())

    wait_until(rests)
    rest = base.remote.state()["truth"]["x"]
    assert rest > began["truth"]["x"] + 0.2
    base.service.signal(signal.SIGCONT)
    base.service.wait_said("s between two packets")
    base.odometry.until(lambda each: each["pose"][0] > rest - 0.03)  # a scan that came before would show more

    def drives_on():
        base.see(*[4.0] * 64)  # with no beam half an increment beyond the view
        base.drive(0.5)
        base.safety.get_within(0.05)
        return base.remote.state()["truth"]["x"] > rest + 0.5

    wait_until(drives_on)


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
    assert "base_control" not in Remote(control, DEADLINE).state()["received"]


def test_a_port_that_is_not_there_says_so_with_the_remedy(client, start, tmp_path):
    safety = client.listen("base/safety")
    service = start("kobuki", "--set", f"kobuki.port={tmp_path}/none", wait=False)
    service.wait_said("no such device: plug the base in")
    assert [safety.get()["rule"] for _ in range(2)] == ["no_base"] * 2
