"""A program on the robot's network that lies, wants to drive, or asks for more than anybody can do.

`python -m benchmarks.faults.intruder KIND --robot NAME --connect ENDPOINT` says that it is ready, waits for a line, and
goes on until it is ended.
"""

import argparse
import itertools
import math
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from threading import Thread

import numpy as np
import zenoh

from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.beam_fields import ABSENT
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import SCAN_FUSED, VELOCITY, command

COMMANDS, REQUESTS = 5000.0, 20_000.0  # [Hz] of a flood
SCANS, DRIVES = 30.0, 50.0  # [Hz]
AHEAD = 0.09  # [s] of a stamp
TOLD_CLEAR = 4.0  # [m]
SPEED = 0.5  # [m/s], straight on
BUNCHES = 200  # a second, of which each has its part of a flood


def free_scan(stamp: int, beams: int, seq: int = 0) -> LaserScan:
    """A scan of a camera's view in which everything is free."""
    half = math.radians(29.0)
    return LaserScan(
        seq=seq,
        stamp=stamp,
        frame="camera_footprint",
        angle_min=-half,
        angle_max=half,
        angle_increment=2.0 * half / (beams - 1),
        time_increment=0.0,
        scan_time=0.033,
        range_min=0.0,
        range_max=TOLD_CLEAR,
        ranges=np.full(beams, np.inf, np.float32),
        intensities=ABSENT,
    )


def at_rate(rate: float, act: Callable[[], object]) -> None:
    """Do something so often a second [Hz], in bunches, for ever."""
    bunch = max(round(rate / BUNCHES), 1)
    began = time.monotonic()
    for done in itertools.count(bunch, bunch):
        for _ in range(bunch):
            act()
        time.sleep(max(began + done / rate - time.monotonic(), 0.0))


class Intruder:
    """What it can do, each for ever."""

    def __init__(self, robot: str, endpoint: str, commands: float, requests: float) -> None:
        """commands, requests: [Hz] of a flood."""
        self._commands, self._requests = commands, requests
        config = zenoh.Config()
        config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", f'["{endpoint}"]')
        self._robot, self._session = robot, zenoh.open(config)

    def future(self) -> None:
        """Scans from the future."""
        at_rate(SCANS, lambda: self._put(SCAN_FUSED.path, free_scan(time.time_ns() + round(AHEAD * 1e9), 640).encode()))

    def two_beams(self) -> None:
        """Scans of two beams."""
        at_rate(SCANS, lambda: self._put(SCAN_FUSED.path, free_scan(time.time_ns(), 2).encode()))

    def drive(self) -> None:
        """Commands beside the driver's."""
        at_rate(DRIVES, lambda: self._put(VELOCITY.path, self._velocity()))

    def flood(self) -> None:
        """Commands and requests, as many as it can send; they are less important than the driver's."""
        put = partial(self._put, VELOCITY.path)
        Thread(target=at_rate, args=(self._commands, lambda: put(self._velocity(priority=-1))), daemon=True).start()
        key = f"{self._robot}/{command('version')}"
        at_rate(self._requests, lambda: self._session.get(key, lambda _: None))

    def _velocity(self, priority: int = 0) -> bytes:
        return Velocity(stamp=time.time_ns(), linear=SPEED, angular=0.0, source="intruder", priority=priority).encode()

    def _put(self, path: str, payload: bytes) -> None:
        self._session.put(f"{self._robot}/{path}", payload)


KINDS = {"future": Intruder.future, "two_beams": Intruder.two_beams, "drive": Intruder.drive, "flood": Intruder.flood}


class Intrusion(AbstractContextManager["Intrusion"]):
    """An intruder in a process of its own, which waits for release() and is ended with the context."""

    def __init__(
        self, kind: str, robot: str, endpoint: str, commands: float = COMMANDS, requests: float = REQUESTS
    ) -> None:
        """Raises RuntimeError where it does not start."""
        where = ["--robot", robot, "--connect", endpoint, "--commands", str(commands), "--requests", str(requests)]
        command = [sys.executable, "-m", "benchmarks.faults.intruder", kind, *where]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        if not (self._process.stdout and self._process.stdout.readline()):
            raise RuntimeError(f"the intruder {kind} did not start")

    def release(self) -> None:
        """Let it begin."""
        if self._process.stdin:
            self._process.stdin.write(b"\n")
            self._process.stdin.flush()

    def end(self) -> None:
        """End it, once or again."""
        self._process.kill()
        self._process.wait()

    def __exit__(self, *_: object) -> None:
        self.end()


def main() -> None:
    """Intrude until ended."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults.intruder", description=__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--robot", required=True)
    parser.add_argument("--connect", required=True)
    parser.add_argument("--commands", type=float, default=COMMANDS, help="[Hz] of a flood")
    parser.add_argument("--requests", type=float, default=REQUESTS, help="[Hz] of a flood")
    asked = parser.parse_args()
    intruder = Intruder(asked.robot, asked.connect, asked.commands, asked.requests)
    print("ready", flush=True)
    sys.stdin.readline()
    KINDS[asked.kind](intruder)


if __name__ == "__main__":
    main()
