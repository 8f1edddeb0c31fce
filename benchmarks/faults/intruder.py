"""A program on the robot's network that lies, wants to drive, or asks for more than anybody can do."""

import itertools
import math
import multiprocessing
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from multiprocessing.synchronize import Event
from threading import Thread
from typing import Literal

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
STARTING = 60.0  # [s]

Kind = Literal["future", "two_beams", "drive", "flood"]


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


class Intrusion(AbstractContextManager["Intrusion"]):
    """An intruder in a process of its own, which waits for release() and is ended with the context."""

    def __init__(
        self, kind: Kind, robot: str, endpoint: str, commands: float = COMMANDS, requests: float = REQUESTS
    ) -> None:
        """commands, requests: [Hz] of a flood. Raises RuntimeError where it does not start."""
        context = multiprocessing.get_context("spawn")
        self._released, ready = context.Event(), context.Event()
        self._process = context.Process(
            target=intrude, args=(kind, (robot, endpoint, commands, requests), ready, self._released)
        )
        self._process.start()
        if not ready.wait(STARTING):
            self.end()
            raise RuntimeError(f"the intruder {kind} did not start")

    def release(self) -> None:
        """Let it begin."""
        self._released.set()

    def end(self) -> None:
        """End it, once or again."""
        self._process.kill()
        self._process.join()

    def __exit__(self, *_: object) -> None:
        self.end()


def intrude(kind: Kind, options: tuple[str, str, float, float], ready: Event, released: Event) -> None:
    """Intrude, once released, until ended; options: of Intruder."""
    intruder = Intruder(*options)
    ready.set()
    released.wait()
    getattr(intruder, kind)()
