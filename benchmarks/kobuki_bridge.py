"""A command's way from the network to the serial port, and what the bridge costs at the base's 50 Hz.

    python -m benchmarks.kobuki_bridge [--commands 500]

The base is emulated here, so that its clock is ours: latency runs from put() to the bytes that tell the new speed. Each
command asks for 1 mm/s less than the one before, which the gate passes at once, and comes with a fused scan. A first
run is made while nobody listens to the base, a second one while somebody listens to odometry, state and gyro.
"""

from __future__ import annotations

import argparse
import select
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from pathlib import Path
from queue import Queue
from typing import NamedTuple

import numpy as np
import psutil
from rich.console import Console
from rich.table import Table

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import Velocity
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.runtime.bus import Bus, Network
from cliffscan.simulator.kobuki.base import Base
from cliffscan.simulator.kobuki.cable import Cable
from cliffscan.simulator.kobuki.commands import BaseControl

TICK = 0.02  # [s] of the base
FASTEST, STEP = 0.65, 0.001  # [m/s]
WARM_UP = 60  # commands in which the base comes up to speed
PERIOD = 0.047  # [s] between commands, so that they meet every phase of the base's ticks
FREE = np.full(640, 4.0, np.float32)


def main() -> None:
    """Run both and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--commands", type=int, default=500)
    options = parser.parse_args()
    robot = f"bench-{uuid.uuid4().hex[:8]}"
    with tempfile.TemporaryDirectory() as folder, Bus(Network(), robot) as bus:
        link = Path(folder) / "kobuki"
        heard: Queue[tuple[float, int]] = Queue()
        ended = threading.Event()
        base = threading.Thread(target=live, args=(link, heard, ended))
        base.start()
        alive = threading.Event()
        bus.watch_alive(lambda name, here: alive.set() if name == "kobuki" and here else None)
        service = subprocess.Popen(
            [sys.executable, "-m", "services.kobuki", "--robot", robot, "--set", f"kobuki.port={link}"]
        )
        try:
            if not alive.wait(20.0):
                raise SystemExit("kobuki does not come to life")
            alone = measure(bus, heard, psutil.Process(service.pid), options.commands)
            for topic in (topics.ODOMETRY, topics.BASE_STATE, topics.IMU):
                bus.subscribe(topic.path, lambda path, payload: None)  # noqa: ARG005
            followed = measure(bus, heard, psutil.Process(service.pid), options.commands)
            show({"nobody": alone, "somebody": followed})
        finally:
            service.terminate()
            service.wait()
            ended.set()
            base.join()


def live(link: Path, heard: Queue[tuple[float, int]], ended: threading.Event) -> None:
    """Be a base by the clock, and note when each speed was heard."""
    base, cable = Base(), Cable(link)
    last = time.monotonic()
    while not ended.is_set():
        if cable.connected:
            select.select([cable.fileno()], [], [], max(0.0, last + TICK - time.monotonic()))
        else:
            time.sleep(TICK)
        for command in base.receive(cable.hear()):
            if isinstance(command, BaseControl):
                heard.put((time.perf_counter(), command.speed))
        now = time.monotonic()
        if now - last >= TICK:
            cable.say(base.step(now - last))
            last = now
    cable.close()


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
    for number in range(-WARM_UP, commands):
        fused.put(free_scan(number + WARM_UP))
        while not heard.empty():
            heard.get()
        speed = FASTEST - STEP * max(number, 0)
        sent = time.perf_counter()
        velocity.put(Velocity(stamp=time.time_ns(), linear=speed, angular=0.0))
        if number >= 0:
            latencies.append(when(heard, int(1000.0 * speed)) - sent)
        time.sleep(max(0.0, PERIOD - (time.perf_counter() - sent)))
    seconds = time.perf_counter() - began
    return Result(latencies, (cpu(process) - used) / seconds, process.memory_info().rss / 2**20)


def when(heard: Queue[tuple[float, int]], speed: int) -> float:
    """When [s] the base was told this speed [mm/s]."""
    while True:
        at, told = heard.get(timeout=5.0)
        if told == speed:
            return at


def free_scan(seq: int) -> LaserScan:
    """A fused scan in which nothing is near."""
    half = float(np.radians(29))
    return LaserScan(
        seq=seq,
        stamp=time.time_ns(),
        frame="camera_footprint",
        angle_min=-half,
        angle_max=half,
        angle_increment=2 * half / 639,
        time_increment=0.0,
        scan_time=PERIOD,
        range_min=0.0,
        range_max=10.0,
        ranges=FREE,
        intensities=np.zeros(640, np.float32),
    )


def cpu(process: psutil.Process) -> float:
    """CPU time [s] so far."""
    times = process.cpu_times()
    return times.user + times.system


def show(results: dict[str, Result]) -> None:
    """Print the figures, by who listens."""
    table = Table(title="command to serial bytes", title_justify="left")
    table.add_column("listens")
    for heading in ("commands", "p50 ms", "p99 ms", "max ms", "CPU % of a core", "resident MiB"):
        table.add_column(heading, justify="right")
    for listens, (latencies, share, memory) in results.items():
        spread = (f"{1e3 * value:.2f}" for value in np.percentile(latencies, (50, 99, 100)))
        table.add_row(listens, str(len(latencies)), *spread, f"{100 * share:.1f}", f"{memory:.0f}")
    Console().print(table)


if __name__ == "__main__":
    main()
