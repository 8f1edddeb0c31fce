"""kobuki does not drive by what lies to it: commands of another time, a stuck base, scans that cannot be."""

import threading
import time

import msgpack
import numpy as np
import pytest

from cliffscan.common.contract.description import CameraDescription, RobotDescription
from tests.service.conftest import DEADLINE, scan

SECOND = 10**9  # [ns]
CAMERA = CameraDescription(frame="camera", simulated=True, nearest_floor=0.7, farthest=4.5, field_of_view=(-0.5, 0.5))


def ask_to_drive(base, late=0.0, **fields):
    stamp = time.time_ns() - round(late * SECOND)
    base.client.put("base/cmd_vel", {"stamp": stamp, "linear": 0.2, "angular": 0.0} | fields)


def until(base, rule, act, holds=lambda _: True):
    """What the gate says when it says `rule`, while `act` goes on."""
    deadline = time.monotonic() + DEADLINE
    while time.monotonic() < deadline:
        act()
        told = base.safety.get_within(0.02)
        if told and told["rule"] == rule and holds(told):
            return told
    pytest.fail(f"the gate did not say {rule}")


@pytest.mark.parametrize(("late", "words"), [(10.0, "10.0 s behind"), (-3600.0, "ahead of this clock")])
def test_a_command_of_another_time_moves_nothing_and_says_why(base, late, words):
    def act():
        base.see()
        ask_to_drive(base, late)

    told = until(base, "no_command", act, lambda told: words in told["note"])
    assert told["allowed"] == [0.0, 0.0]
    base.until("free", linear=0.2)


def test_one_source_drives_at_a_time_and_a_higher_priority_takes_over(base):
    def both(priority):
        base.see()
        ask_to_drive(base, source="first")
        ask_to_drive(base, source="second", priority=priority, linear=-0.1)

    until(base, "free", lambda: (base.see(), ask_to_drive(base, source="first")))
    told = until(base, "free", lambda: both(0), lambda told: "'second' is refused" in told["note"])
    assert told["asked"] == pytest.approx([0.2, 0.0])
    until(base, "free", lambda: both(1), lambda told: told["asked"] == pytest.approx([-0.1, 0.0]))


@pytest.mark.parametrize(("fault", "mended"), [("clock off", "clock on"), ("repeat on", "repeat off")])
def test_a_base_whose_clock_stands_still_is_silent(base, fault, mended):
    base.until("free", linear=0.2)
    base.remote.tell(fault)
    told = base.until("no_base", linear=0.2)
    assert told["allowed"] == [0.0, 0.0]
    base.client.wait_alive("kobuki", False)
    base.remote.tell(mended)
    base.client.wait_alive("kobuki")
    base.until("free", linear=0.2)


@pytest.mark.parametrize(
    ("fault", "words"), [("encoders 0 0", ["stands still"]), ("encoders 1 0", ["stands still", "by the gyro"])]
)
def test_wheels_that_are_told_to_turn_and_do_not_stop_it(base, fault, words):
    while base.odometry.get()["pose"][0] < 0.2:
        base.see()
        base.drive(0.3)
    base.remote.tell(fault)
    told = base.until("odometry", linear=0.3)
    assert any(each in told["note"] for each in words)  # of two that see it, the one that is quicker
    assert (told["latched"], told["allowed"]) == (True, [0.0, 0.0])
    base.wait_at_rest()
    base.remote.tell("encoders 1 1")
    assert base.ask("clear_safety")["ok"]
    base.until("free", linear=0.3)


def test_encoders_that_leap_are_not_motion(base):
    base.until("free", linear=0.2)
    base.remote.tell("skip 0.48")
    base.remote.tell("encoders 100 100")
    told = base.until("odometry", linear=0.2)
    assert "contradicts itself" in told["note"]
    base.wait_at_rest()
    base.odometry.all()
    assert abs(base.odometry.get()["pose"][0] - base.remote.state()["truth"]["x"]) < 0.5


def future(base):
    return scan(np.full(40, np.inf), time.time_ns() + 90_000_000)


def two_beams(base):
    return scan([np.inf, np.inf], time.time_ns())


@pytest.mark.parametrize(("lie", "words"), [(future, "ahead of this clock"), (two_beams, "degrees wide")])
def test_a_scan_that_cannot_be_frees_nothing_and_holds_no_honest_one_up(base, lie, words):
    def act():
        base.client.put("scan/fused", lie(base))
        ask_to_drive(base)

    told = until(base, "no_scan", act, lambda told: words in told["note"])
    assert told["allowed"][0] == 0.0
    until(base, "free", lambda: (act(), base.see()))


def test_a_scan_frees_no_more_than_the_described_camera_sees(base):
    base.until("free", linear=0.2)
    high = RobotDescription(stamp=1, camera=CAMERA.model_copy(update={"field_of_view": (0.3, 0.5)}))
    base.client.put("description", high.encode())
    base.remote.tell("power_cycle 0.1")  # what was free before is not any more
    told = base.until("obstacle", linear=0.2)
    assert "unseen floor" in told["note"]


def test_the_base_says_what_it_is(base):
    reply = next(iter(base.client.session.get(f"{base.client.robot}/description", timeout=DEADLINE)))
    body = msgpack.unpackb(reply.ok.payload.to_bytes())["body"]
    assert body == {"simulated": True, "radius": 0.18, "footprint": [], "height": 0.42}


def test_what_holds_the_robot_back_is_named(base):
    def act():
        base.see(0.8)
        base.drive(0.3)

    until(base, "obstacle", act, lambda told: "obstacle ahead" in told["note"] and "from the hull" in told["note"])


@pytest.fixture
def flood(base):
    """Commands and requests of somebody else, as many as one thread of this process can send, until the end."""
    ended = threading.Event()
    session, robot = base.client.session, base.client.robot

    def work():
        moving = {"linear": 0.2, "angular": 0.0, "source": "flood", "priority": -1}
        while not ended.is_set():
            session.put(f"{robot}/base/cmd_vel", msgpack.packb({"stamp": time.time_ns()} | moving))
            for _ in range(4):
                session.get(f"{robot}/base/command/version", lambda _: None)

    thread = threading.Thread(target=work)
    thread.start()
    yield
    ended.set()
    thread.join()


def test_a_stop_reaches_the_wheels_through_a_flood(base, flood):
    base.until("free", linear=0.3)
    assert base.ask("stop")["ok"]
    told = base.until("stopped", linear=0.3)
    assert told["allowed"] == [0.0, 0.0]
    base.wait_at_rest()
