"""All services of a robot over two routers with keys: the workstation sees, drives and stops, and clears nothing."""

import sys
import time

import msgpack
import pytest
import zenoh

from cliffscan.secure.folder import KeyFolder
from tests.service.conftest import DEADLINE, Ear, repeated, wait_until
from tests.service.test_secure_door import opened, secured_endpoint

SPEED = 0.5  # [m/s]
EDGE, RADIUS = 3.0, 0.1775  # [m] where the stairs of `landing` begin, and the robot's disc
WORLD = ["--base", "simulated", "--world", "landing", "--set", "capture.rate=10"]


@pytest.mark.slow
def test_from_the_workstation_the_robot_is_driven_to_the_stairs(tmp_path, run):
    keys = tmp_path / "keys"
    KeyFolder(keys).init("r", [])
    near, far = secured_endpoint(), secured_endpoint()
    sides = (
        run(up("robot", "--secure", keys, "--listen", near, *WORLD)),
        run(up("workstation", "--secure", keys, "--connect", near, "--listen", far)),
    )
    driver, here = reached(keys, "driver", far), reached(keys, "operator", near)
    odometry, scans = Ear(driver, "r/base/odom"), Ear(here, "r/scan/fused")
    states, safety = Ear(here, "r/base/state"), Ear(here, "r/base/safety")
    scans.get()  # from the workstation, of the robot's frames
    with driving(driver):
        safety.until(lambda told: told["rule"] == "obstacle")
        stopped = odometry.until(lambda told: abs(told["twist"][0]) < 0.01 and told["pose"][0] > 1.0)
        assert ask(driver, "stop") == [True]
        safety.until(lambda told: told["rule"] == "stopped")
        assert ask(driver, "clear_safety") == []
        assert ask(here, "clear_safety") == [True]
        safety.until(lambda told: told["rule"] == "obstacle")
    assert 2.0 < stopped["pose"][0] < EDGE - RADIUS
    assert not any(any(each["wheel_drops"]) or any(each["cliffs"]) for each in states.all())
    assert not any("may not" in each.said or "shows itself to no" in each.said for each in sides)
    driver.close()
    here.close()


def up(part, *options):
    return [sys.executable, "-m", "cliffscan", "up", "--robot", "r", "--part", part, *map(str, options)]


def reached(keys, role, endpoint):
    """A session of that role, as soon as its router is there."""
    sessions = []

    def here():
        try:
            sessions.append(opened(keys, role, connect=endpoint))
        except zenoh.ZError:
            return False
        return True

    wait_until(here)
    return sessions[0]


def driving(session):
    """Publish base/cmd_vel, straight ahead, ten times a second meanwhile."""
    publisher = session.declare_publisher("r/base/cmd_vel")
    ahead = {"linear": SPEED, "angular": 0.0}
    return repeated(lambda: publisher.put(msgpack.packb({"stamp": time.time_ns()} | ahead)), 0.1)


def ask(session, name):
    """Whether the base did what it was asked to; empty where the request does not come to it."""
    replies = session.get(f"r/base/command/{name}", payload=msgpack.packb({}), timeout=DEADLINE)
    return [msgpack.unpackb(reply.ok.payload.to_bytes())["ok"] for reply in replies if reply.ok]
