"""A command's way from the network to the serial port, and what the bridge costs at the base's 50 Hz.

    python -m benchmarks.kobuki_bridge [--commands 500]

The base is emulated here, so that its clock is ours: latency runs from put() to the bytes that tell the new speed. Each
command asks for 1 mm/s less than the one before, which the gate passes at once, and comes with a fused scan; after 600
the base comes up to speed again. A first
run is made while nobody listens to the base, a second one while somebody listens to odometry, state and gyro.
"""

import argparse
import tempfile
import threading
import time
import uuid
from collections.abc import Iterator
from pathlib import Path
from queue import Queue
from typing import NamedTuple

import numpy as np
import psutil
from rich.console import Console

from benchmarks.faults.intruder import free_scan
from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import Network
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.commands import BaseControl, Command
from cliffscan.simulator.kobuki.runner import Runner, run
from evaluation.processes.network import free_endpoint
from evaluation.processes.started import Started, cpu
from evaluation.tables import Table

FASTEST, STEP = 0.65, 0.001  # [m/s]
WARM_UP = 60  # commands in which the base comes up to speed
ROUND = 600  # commands that are measured before it comes up to speed again
PERIOD = 0.047  # [s] between commands, so that they meet every phase of the base's ticks
BEAMS = 640  # of a fused scan
HEADINGS = ("listens", "commands", "p50 ms", "p99 ms", "max ms", "CPU % of a core", "resident MiB")


def main() -> None:
    """Run both and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--commands", type=int, default=500)
    options = parser.parse_args()
    robot, endpoint = f"bench-{uuid.uuid4().hex[:8]}", free_endpoint()
    base, ended, alive = ListeningBase(), threading.Event(), threading.Event()
    with tempfile.TemporaryDirectory() as folder, Bus(Network("router", [], [endpoint]), robot) as bus:
        link = Path(folder) / "kobuki"
        runner = Runner.open(base, link, None)
        living = threading.Thread(target=run, args=(runner, ended))
        living.start()
        bus.watch_alive(lambda name, here: alive.set() if name == "kobuki" and here else None)
        try:
            with Started() as started:
                service = started.service("kobuki", robot, endpoint, f"kobuki.port={link}")
                if not alive.wait(20.0):
                    raise SystemExit("kobuki does not come to life")
                alone = measure(bus, base.heard, service, options.commands)
                for topic in (topics.ODOMETRY, topics.BASE_STATE, topics.IMU):
                    bus.subscribe(topic.path, lambda path, payload: None)  # noqa: ARG005
                followed = measure(bus, base.heard, service, options.commands)
        finally:
            ended.set()
            living.join()
            runner.cable.close()
    Console().print(table({"nobody": alone, "somebody": followed}).rich())


class ListeningBase(Base):
    """A base that notes when it was told each speed [mm/s]."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: Queue[tuple[float, int]] = Queue()

    def receive(self, data: bytes) -> list[Command]:
        """Hear bytes from the driver."""
        commands, now = super().receive(data), time.perf_counter()
        for command in commands:
            if isinstance(command, BaseControl):
                self.heard.put((now, command.speed))
        return commands


class Result(NamedTuple):
    """What one run gave."""

    latencies: list[float]  # [s]
    share: float  # of a core
    memory: float  # [MiB] resident


def measure(bus: Bus, heard: Queue[tuple[float, int]], process: psutil.Process, commands: int) -> Result:
    """Drive the robot for some commands."""
    velocity, fused = bus.publisher(topics.VELOCITY), bus.publisher(topics.SCAN_FUSED)
    latencies: list[float] = []
    began, used = time.perf_counter(), cpu(process)
    for number, (measured, speed) in enumerate(speeds(commands)):
        fused.put(free_scan(time.time_ns(), BEAMS, number))
        while not heard.empty():
            heard.get()
        sent = time.perf_counter()
        velocity.put(Velocity(stamp=time.time_ns(), linear=speed, angular=0.0))
        if measured:
            latencies.append(when(heard, int(1000.0 * speed)) - sent)
        time.sleep(max(0.0, PERIOD - (time.perf_counter() - sent)))
    seconds = time.perf_counter() - began
    return Result(latencies, (cpu(process) - used) / seconds, process.memory_info().rss / 2**20)


def speeds(commands: int) -> Iterator[tuple[bool, float]]:
    """Whether a command is measured, and its speed [m/s]: rounds of falling ones, each after a warm-up."""
    for begun in range(0, commands, ROUND):
        yield from ((False, FASTEST) for _ in range(WARM_UP))
        yield from ((True, FASTEST - STEP * step) for step in range(min(ROUND, commands - begun)))


def when(heard: Queue[tuple[float, int]], speed: int) -> float:
    """When [s] the base was told this speed [mm/s]."""
    while True:
        at, told = heard.get(timeout=5.0)
        if told == speed:
            return at


def table(results: dict[str, Result]) -> Table:
    """The figures, by who listens."""
    rows = []
    for listens, (latencies, share, memory) in results.items():
        spread = (f"{1e3 * value:.2f}" for value in np.percentile(latencies, (50, 99, 100)))
        rows.append((listens, str(len(latencies)), *spread, f"{100 * share:.1f}", f"{memory:.0f}"))
    return Table("command to serial bytes", HEADINGS, rows)


if __name__ == "__main__":
    main()
