"""An emulated base on a pty, and the service that drives it."""

import sys
import time

import numpy as np
import pytest

from cliffscan.simulator.kobuki.client import Remote
from tests.service.conftest import DEADLINE, scan, wait_until


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
        deadline = time.monotonic() + DEADLINE
        while time.monotonic() < deadline:
            if linear is not None:
                self.see(*ranges)
                self.drive(linear, angular)
            told = self.safety.get_within(0.05)
            if told and told["rule"] == rule:
                return told
        pytest.fail(f"the gate did not say {rule}")

    def moves(self):
        return self.remote.state()["target"]

    def wait_at_rest(self):
        wait_until(lambda: not any(self.moves().values()))


@pytest.fixture
def base(client, run, start, tmp_path):
    made = Base(client, tmp_path)
    emulator = run([sys.executable, "-m", "simulator.kobuki", "--link", str(made.link), "--control", str(made.control)])
    emulator.wait_said("ready")
    made.remote = Remote(made.control, DEADLINE)
    made.service = start("kobuki", "--set", f"kobuki.port={made.link}")
    return made
