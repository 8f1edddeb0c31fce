"""The gate for any base, through the wire: it lets a base drive that it knows, and stops it in every doubt."""

import time

import numpy as np
import pytest

from tests.external_base import ExternalBase
from tests.service.conftest import DEADLINE, scan, wait_until


class Guarded:
    """The service, a base of another make, and somebody who sees and drives."""

    def __init__(self, client, base) -> None:
        self.client, self.base = client, base
        self.safety = client.listen("base/safety")
        self.seq = 0

    def drive(self, linear=0.3, wall=4.0):
        """See a wall that far from where the robot began, and command it towards there."""
        self.seq += 1
        ranges = max(wall - self.base.pose[0], 0.05)
        stamp = time.time_ns()
        self.client.put("scan/fused", scan(np.full(20, ranges), stamp, seq=self.seq))
        self.client.put("base/cmd_vel", {"stamp": stamp, "linear": linear, "angular": 0.0})

    def until(self, holds, **how):
        """Drive on until the gate publishes a state of which `holds` is true."""
        deadline = time.monotonic() + DEADLINE
        while time.monotonic() < deadline:
            self.drive(**how)
            state = self.safety.get_within(0.05)
            if state and holds(state):
                return state
        pytest.fail("the gate did not publish that")

    def until_rule(self, rule, **how):
        return self.until(lambda state: state["rule"] == rule, **how)

    def until_it(self, holds, **how):
        wait_until(lambda: self.drive(**how) or holds())

    def wait_at_rest(self):
        wait_until(lambda: self.base.speed == [0.0, 0.0])


@pytest.fixture
def guarded(client, start):
    with ExternalBase(client) as base:
        start("gate", "--set", "gate.simulated=true")
        yield Guarded(client, base)


def test_a_free_robot_drives_and_the_body_is_described(client, guarded):
    guarded.until_rule("free")
    guarded.until_it(lambda: guarded.base.pose[0] > 0.1, linear=0.3)
    (reply,) = client.session.get(f"{client.robot}/description", timeout=DEADLINE)
    assert b"footprint" in reply.ok.payload.to_bytes()
    last = guarded.base.commands[-1]
    assert (last["source"], last["angular"]) == ("gate", 0.0)
    assert abs(time.time_ns() - last["stamp"]) < DEADLINE * 1e9


def test_it_stops_before_what_the_scan_shows(guarded):
    guarded.until_rule("obstacle", wall=1.2)
    guarded.until_it(lambda: guarded.base.pose[0] > 0.4, wall=1.2)
    guarded.until(lambda state: state["allowed"][0] < 0.05, wall=1.2)
    guarded.wait_at_rest()
    assert guarded.base.pose[0] < 1.2 - 0.087 - 0.18


@pytest.mark.parametrize(("what", "note"), [("silent", "no odometry comes"), ("late", "synchronise the clocks")])
def test_without_odometry_of_now_it_commands_to_stand(guarded, what, note):
    guarded.until_it(lambda: guarded.base.speed[0] > 0.1, linear=0.3)
    if what == "silent":
        guarded.base.publishing = False
    else:
        guarded.base.offset = -(10**9)
    guarded.until(lambda state: state["rule"] == "no_base" and note in state["note"])
    guarded.wait_at_rest()
    assert guarded.base.commands[-1]["linear"] == 0.0


def test_a_base_that_does_not_follow_is_not_driven_until_it_is_cleared(client, guarded):
    guarded.base.driven = False
    state = guarded.until(lambda state: state["rule"] == "odometry" and state["latched"])
    assert "clear_safety" in state["note"]
    guarded.base.driven = True
    assert client.ask("base/command/clear_safety", {})["ok"]
    guarded.until_rule("free")


def test_contacts_count_where_the_base_has_them_and_must_not_fall_silent(client, guarded):
    guarded.until_rule("free")
    state = {
        "stamp": time.time_ns(), "bumpers": [False, True, False], "cliffs": [False] * 3, "cliff_counts": [0] * 3,
        "wheel_drops": [False] * 2, "overcurrents": [False] * 2, "currents": [0.0] * 2, "buttons": [False] * 3,
        "battery_voltage": 12.0, "battery_percent": 50.0, "charger": "unknown", "dock_ir": [0] * 3,
        "digital_inputs": [False] * 4, "analog_inputs": [0.0] * 4,
    }  # fmt: skip
    client.put("base/state", state)
    guarded.until_rule("bumper")
    assert "base/state" in guarded.until_rule("no_base")["note"]


def test_stop_holds_and_nothing_else_is_answered(client, guarded):
    assert client.ask("base/command/stop", {})["ok"]
    assert guarded.until_rule("stopped")["latched"]
    answer = client.ask("base/command/led", {})
    assert (answer["ok"], answer["message"]) == (False, "no such command; there are stop, clear_safety")


def test_the_last_word_of_a_gate_that_ends_is_to_stand(client, start):
    with ExternalBase(client) as base:
        process = start("gate", "--set", "gate.simulated=true")
        guarded = Guarded(client, base)
        guarded.until_it(lambda: base.speed[0] > 0.1, linear=0.3)
        process.signal(15)
        assert process.end() == 0
        guarded.wait_at_rest()
        client.wait_alive("gate", alive=False)


def test_a_real_base_is_not_driven_by_a_simulated_camera(client, start):
    with ExternalBase(client) as base:
        start("gate")
        start("capture", "--set", "capture.source=simulator")
        assert "the camera is simulated" in Guarded(client, base).until_rule("refused")["note"]
        assert base.speed == [0.0, 0.0]
