"""Capture to fused, through a router on one machine: frames lost, latency, and each process's memory and CPU.

    python -m benchmarks.pipeline [--frames 1000] [--rate 30] [--raw]

Latency runs from the frame's stamp, taken before the simulator draws it, to the fused scan's arrival here.
"""

import argparse
import time
import uuid
from typing import NamedTuple

import numpy as np
import psutil
from rich.console import Console

from cliffscan.common.contract import topics
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import PATIENCE
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint
from evaluation.processes.started import cpu
from evaluation.tables import Table

WARM_UP = 60  # frames left out, while caches fill and sessions settle
SAMPLES = 10  # looks at each process's memory
MIB = 2**20
PIPELINE = ("frames", "lost", "Hz", "p50 ms", "p95 ms", "p99 ms", "max ms")
PROCESSES = ("process", "CPU % of a core", "resident MiB: first", "last", "most")


class Usage(NamedTuple):
    """A process over the run: resident memory [MiB] at each look, and CPU time [s]."""

    resident: list[float]
    cpu: float


class Run(NamedTuple):
    """Figures of one run. latencies: (frames,) [s] in order; lost: sequence numbers that never came."""

    latencies: np.ndarray
    lost: int
    seconds: float
    usage: dict[str, Usage]


def measure(plan: Plan, frames: int) -> Run:
    """Let `frames` frames through the whole system."""
    queue: LatestQueue[tuple[int, bytes]] = LatestQueue(room=1024)
    stop = StopSignal()
    with System(plan, stop) as system:
        system.bus.subscribe(topics.SCAN_FUSED.path, lambda _, payload: queue.put((time.time_ns(), payload)))
        processes: dict[str, psutil.Process] = {}
        looks: dict[str, list[float]] = {}
        latencies: list[float] = []
        first = last = -1
        every = max(1, frames // SAMPLES)
        started = 0.0
        cpu_before: dict[str, float] = {}
        while len(latencies) < frames and not stop.is_set():
            arrived = queue.get(PATIENCE)
            system.poll()
            if not arrived:
                continue
            at, payload = arrived
            scan = LaserScan.decode(payload)
            if scan.seq < WARM_UP:
                continue
            if first < 0:
                first, started = scan.seq, time.monotonic()
                processes = {name: psutil.Process(child.pid) for name, child in system.supervisor.children.items()}
                looks = {name: [] for name in processes}
                cpu_before = {name: cpu(process) for name, process in processes.items()}
            if len(latencies) % every == 0:
                for name, process in processes.items():
                    looks[name].append(process.memory_info().rss / MIB)
            last = scan.seq
            latencies.append((at - scan.stamp) * 1e-9)
        usage = {name: Usage(looks[name], cpu(process) - cpu_before[name]) for name, process in processes.items()}
        return Run(np.array(latencies), last - first + 1 - len(latencies), time.monotonic() - started, usage)


def tables(run: Run) -> list[Table]:
    """The figures for people."""
    spread = (f"{1e3 * value:.1f}" for value in np.percentile(run.latencies, (50, 95, 99, 100)))
    figures = str(len(run.latencies)), str(run.lost), f"{len(run.latencies) / run.seconds:.1f}", *spread
    rows = [
        (name, *(f"{value:.1f}" for value in (100 * cpu / run.seconds, resident[0], resident[-1], max(resident))))
        for name, (resident, cpu) in run.usage.items()
    ]
    return [Table("capture to fused", PIPELINE, [figures], 0), Table("processes", PROCESSES, rows)]


def main() -> None:
    """Run once and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--rate", type=float, default=30.0, help="[Hz]")
    parser.add_argument("--raw", action="store_true", help="send depth uncompressed")
    options = parser.parse_args()
    settings = [
        "capture.source=simulator",
        f"capture.rate={options.rate}",
        f"capture.compressed={str(not options.raw).lower()}",
    ]
    plan = Plan(f"bench-{uuid.uuid4().hex[:8]}", (free_endpoint(),), overrides=settings)
    for table in tables(measure(plan, options.frames)):
        Console().print(f"\n{table.title}", table.rich())


if __name__ == "__main__":
    main()
