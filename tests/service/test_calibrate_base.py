"""`cliffscan calibrate --base` finds what a simulated base is like, through its gate, or says why it cannot."""

import threading
import tomllib

import pytest

from tests import forked
from tests.external_base import ExternalBase
from tests.service.conftest import DEADLINE, wait_until

TRIES = 10  # on a machine that is busy with other tests
STALLED = "between two messages of odometry", "the odometry has stopped"


@pytest.fixture
def calibrate(client):
    def ask(*options, answer="yes\n"):
        place = ["--robot", client.robot, "--connect", client.endpoint, "--mode", "client"]
        return forked.ask("cliffscan", "calibrate", "--base", *place, *options, answer=answer, timeout=2 * DEADLINE)

    return ask


@pytest.mark.slow
def test_the_brakes_of_a_base_of_another_make_are_found(client, start, calibrate):
    """In one of some measurements: where the simulated base's own thread stalls, none is made."""
    with ExternalBase(client, dead_time=0.15, deceleration=0.8, turning=3.0):
        start("gate", "--set", "gate.simulated=true", "--set", "gate.require_scan=false")
        assert any(is_near(calibrate()) for _ in range(TRIES))


def is_near(done):
    if done.returncode:
        assert any(stalled in done.stderr for stalled in STALLED), done.stderr
        return False
    found = tomllib.loads(done.stdout)["gate"]
    near = 0.5 < found["deceleration"] <= 0.85 and 100 < found["angular_deceleration"] <= 185
    return near and 0.15 < found["reaction"] < 0.5  # a busy machine is late itself


def test_whatever_ends_it_the_robot_is_commanded_to_stand(client, start, calibrate):
    commands = client.listen("base/cmd_vel")

    def silence():
        wait_until(lambda: base.speed[0] > 0.1)
        base.publishing = False

    with ExternalBase(client) as base:
        start("gate", "--set", "gate.simulated=true", "--set", "gate.require_scan=false")
        silent = threading.Thread(target=silence)
        silent.start()
        done = calibrate()
        silent.join()
    assert (done.returncode, done.stdout) == (1, "")
    assert "the odometry has stopped" in done.stderr
    commands.until(lambda velocity: velocity["linear"] > 0.0)
    commands.until(lambda velocity: velocity["linear"] == 0.0)
    assert all(velocity["linear"] == 0.0 for velocity in commands.all())


def test_a_robot_is_driven_only_when_a_person_says_so(client, start, calibrate):
    with ExternalBase(client) as base:
        start("gate", "--set", "gate.simulated=true", "--set", "gate.require_scan=false")
        done = calibrate(answer="no\n")
        assert base.pose == (0.0, 0.0, 0.0)
    assert (done.returncode, done.stdout) == (1, "")
    assert "1.5 m ahead" in done.stderr
    assert done.stderr.endswith("cliffscan: nothing was driven\n")


def test_without_odometry_the_remedy_is_told(calibrate):
    done = calibrate()
    assert done.returncode == 1
    assert "start the base's service" in done.stderr
