"""A fleet through several processes of perception: scans, latency, what each side costs, and how soon one takes over.

    python -m benchmarks.fleet [--robots 4 8 14] [--rate 30] [--processes 2] [--seconds 10] [--kill]

Processes of their own publish the frames of the robots, drawn before or from a depth folder (--data), spread over the
period, so that what they cost is told apart from perception and from the router. Latency runs from the put of a frame
to the arrival of its fused scan here. --kill ends one process of perception by SIGKILL halfway: the longest gap between
two scans of a robot is then the time until another process serves it.
"""

import argparse
import time
import uuid
from collections import defaultdict
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
import psutil
from rich.console import Console

from benchmarks.pipeline_fleet import LATEST, MIB, drawn
from cliffscan.common.contract import topics
from cliffscan.common.contract.depth_codec import LEVELS
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.bus import EVERY, Bus
from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.service import connect
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.replay import open_recorded
from cliffscan.services.perception.standing import CLAIM
from evaluation.processes.network import free_endpoint
from evaluation.processes.started import Started, cpu
from evaluation.tables import Table

SENDERS = 2  # processes that publish the frames of all robots
SETTLING = 2.0  # [s] that are left out when the robots are shared
LAST = 0.5  # [s] for the last scans to arrive
RECORDED = 60  # frames of a depth folder, which come again and again
WAITING = 4096  # scans that may wait here
HEADINGS = (
    *(
        "robots",
        "Hz of each: offered",
        "scans",
        "least",
        "p50 ms",
        "p99 ms",
        "not answered %",
        "twice",
        "longest gap s",
    ),
    *("CPU % of a core: perception", "for each robot", "router", "senders", "MiB", "load"),
)


class Run(NamedTuple):
    """Figures of one run. by_robot: when each fused scan came [ns], and its header; CPU as shares of a core."""

    by_robot: dict[str, list[tuple[int, LaserScan]]]
    seconds: float
    perception: float
    router: float
    senders: float
    resident: float  # [MiB]


def recorded(folder: Path) -> list[DepthImage]:
    """The first frames of a depth folder."""
    source = open_recorded(CaptureConfig(source="replay", path=str(folder)))
    frames = [image.read() for image in islice(source.images(), RECORDED)]
    return [DepthImage.pack(0, 0, "camera", each.depth, each.camera, LEVELS, 1 / 30) for each in frames]


def send(endpoint: str, names: Sequence[str], rate: float, images: Sequence[DepthImage]) -> None:
    """Publish frames of these robots until the process is told to end."""
    stop = StopSignal()
    bus = connect(Network("client", [endpoint]), names[0], stop)
    if bus is None:
        return
    with bus:
        publishers = [bus.beside(name).publisher(topics.DEPTH) for name in names]
        begin, number = time.monotonic(), 0
        while not stop.is_set():
            sequence, robot = divmod(number, len(names))
            stop.wait(max(0.0, begin + number / (rate * len(names)) - time.monotonic()))
            image = images[(sequence + robot) % len(images)]
            publishers[robot].put(image.model_copy(update={"seq": sequence, "stamp": time.time_ns()}))
            number += 1


class Receiver:
    """All fused scans, and which processes claim a robot."""

    def __init__(self, bus: Bus) -> None:
        self.arrivals: list[tuple[str, int, bytes]] = []  # robot, [ns], payload
        self.claims: set[str] = set()
        every = bus.beside(EVERY)
        every.subscribe_robots(topics.SCAN_FUSED.path, self._scan, WAITING, lambda _: True, lambda *_: None)
        every.watch_robots(self._token)

    def _scan(self, robot: str, payload: bytes) -> None:
        self.arrivals.append((robot, time.time_ns(), payload))

    def _token(self, _robot: str, service: str, here: bool) -> None:
        if here and service.startswith(CLAIM):
            self.claims.add(service)


def measure(options: argparse.Namespace, robots: int) -> Run:
    """Let the frames of so many robots through."""
    endpoint = free_endpoint()
    names = [f"bench-{uuid.uuid4().hex[:8]}" for _ in range(robots)]
    where = ("--robot", "*", "--mode", "client", "--connect", endpoint)
    with ExitStack() as entered:
        started = entered.enter_context(Started())
        router = started.module("cliffscan", "router", "--listen", endpoint)
        bus = connect(Network("client", [endpoint]), "bench", StopSignal())
        if bus is None:
            raise SystemExit(0)
        entered.enter_context(bus)
        receiver = Receiver(bus)
        perception = [started.module("cliffscan.services.perception", *where) for _ in range(options.processes)]
        shares = [share for first in range(SENDERS) if (share := names[first::SENDERS])]
        data = ("--data", options.data) if options.data else ()
        senders = [
            started.module("benchmarks.fleet", "--rate", options.rate, *data, "--send", endpoint, *share)
            for share in shares
        ]
        wait(lambda: {robot for robot, *_ in list(receiver.arrivals)} == set(names), "the robots are not served")
        wait(lambda: len(receiver.claims) >= min(options.processes, robots), "not every process takes a share")
        time.sleep(SETTLING)
        return watch(receiver, (perception, [router], senders), options)


def wait(holds: Callable[[], bool], otherwise: str) -> None:
    """Wait for a fact. Raises SystemExit where it does not come."""
    deadline = time.monotonic() + LATEST
    while not holds():
        if time.monotonic() > deadline:
            raise SystemExit(otherwise)
        time.sleep(0.1)


def watch(receiver: Receiver, processes: Sequence[Sequence[psutil.Process]], options: argparse.Namespace) -> Run:
    """Let the time pass, and count. With a kill the CPU is that of the processes that are left."""
    perception = list(processes[0])
    if options.kill:
        victim = perception.pop()
    groups = (perception, *processes[1:])
    before = [sum(map(cpu, group)) for group in groups]
    first, began = time.time_ns(), time.monotonic()
    time.sleep(options.seconds / 2)
    if options.kill:
        victim.kill()
    time.sleep(began + options.seconds - time.monotonic())
    seconds, last = time.monotonic() - began, time.time_ns()
    own, router, senders = ((sum(map(cpu, group)) - used) / seconds for group, used in zip(groups, before, strict=True))
    resident = sum(process.memory_info().rss for process in perception) / MIB
    time.sleep(LAST)
    by_robot = defaultdict(list)
    for robot, at, payload in receiver.arrivals:
        if first <= at <= last:
            by_robot[robot].append((at, LaserScan.decode(payload)))
    return Run(by_robot, seconds, own, router, senders, resident)


def row(run: Run, robots: int, rate: float) -> tuple[str, ...]:
    """A run's figures for people."""
    scans = [len(each) / run.seconds for each in run.by_robot.values()]
    latencies = [(at - scan.stamp) * 1e-6 for each in run.by_robot.values() for at, scan in each]
    twice = sum(len(each) - len({scan.seq for _, scan in each}) for each in run.by_robot.values())
    gaps = [np.diff([at for at, _ in each]).max(initial=0) * 1e-9 for each in run.by_robot.values()]
    sent = sum(each[-1][1].seq - each[0][1].seq + 1 for each in run.by_robot.values())
    lost = 100 * (1 - (sum(map(len, run.by_robot.values())) - twice) / sent)
    figures = f"{rate:g}", f"{np.mean(scans):.1f}", f"{min(scans):.1f}"
    spread = (f"{value:.1f}" for value in np.percentile(latencies, (50, 99)))
    costs = (f"{100 * each:.0f}" for each in (run.router, run.senders))
    own = f"{100 * run.perception:.0f}", f"{100 * run.perception / robots:.1f}"
    rest = f"{run.resident:.0f}", f"{psutil.getloadavg()[0]:.1f}"
    return (str(robots), *figures, *spread, f"{lost:.1f}", str(twice), f"{max(gaps):.2f}", *own, *costs, *rest)


def main() -> None:
    """Run each number of robots and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, nargs="+", default=[4, 8, 14])
    parser.add_argument("--rate", type=float, default=30.0, help="[Hz] of each robot")
    parser.add_argument("--processes", type=int, default=2, help="of perception")
    parser.add_argument("--seconds", type=float, default=10.0, help="of each run")
    parser.add_argument("--data", type=Path, help="a depth folder; by default frames are drawn")
    parser.add_argument("--kill", action="store_true", help="end one process of perception halfway")
    parser.add_argument("--send", nargs="+", help=argparse.SUPPRESS)  # endpoint and robots, of a sender
    options = parser.parse_args()
    if options.send:
        endpoint, *names = options.send
        send(endpoint, names, options.rate, recorded(options.data) if options.data else drawn(LEVELS, pitch=1.0))
        return
    rows = [row(measure(options, robots), robots, options.rate) for robots in options.robots]
    title = f"{options.processes} processes of perception, {psutil.cpu_count()} cores"
    Console(width=200).print(title, Table(title, HEADINGS, rows).rich())


if __name__ == "__main__":
    main()
