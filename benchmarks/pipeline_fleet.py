"""Depth frames of several robots in, fused scans out, through a router: three services a robot, or one perception.

    python -m benchmarks.pipeline_fleet [--robots 1] [--rate 30] [--frames 300] [--compressed] [--only perception]

This process publishes frames that were drawn before, each with another floor plane, as a tracker gives them. Latency
runs from the put of a frame to the arrival of its fused scan here. CPU and memory are those of the perceiving processes
together, without the router's.
"""

import argparse
import math
import time
import uuid
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import psutil
from rich.console import Console

from cliffscan.common.contract import topics
from cliffscan.common.contract.camera import FloorPlane, Intrinsics
from cliffscan.common.contract.depth_codec import LEVELS, RAW
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.service import connect
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.kinect import kinect_camera
from evaluation.processes.network import free_endpoint
from evaluation.processes.started import Started, cpu
from evaluation.tables import Table

THREE = ("negative", "positive", "fuse")
VARIANTS = ("three services", "perception")
DRAWN = 12  # different frames, each of which comes again and again
WARM_UP = 30  # frames of each robot that are left out
LATEST = 60.0  # [s] for all services to be ready
LAST = 1.0  # [s] for the last scan to arrive
MIB = 2**20
HEADINGS = ("variant", "frames", "lost", "p50 ms", "p99 ms", "CPU % of a core", "for each robot", "resident MiB")


class Run(NamedTuple):
    """Figures of one run. latencies: [s] of the frames that were answered."""

    latencies: list[float]
    sent: int
    share: float  # of a core
    resident: float  # [MiB]


def drawn(encoding: str, pitch: float, coarser: int = 1) -> list[DepthImage]:
    """Noisy frames of a room by a camera that looks `pitch` [deg] down and nods a little, with their floor planes.

    coarser: how many times fewer rows and columns than a Kinect's they have.
    """
    kinect, images = kinect_camera(), []
    width, height = kinect.width // coarser, kinect.height // coarser
    fx, fy, cx, cy = kinect.intrinsics
    middle = 0.5 * (coarser - 1)  # of the pixels that become one
    intrinsics = Intrinsics(fx / coarser, fy / coarser, (cx - middle) / coarser, (cy - middle) / coarser)
    for number in range(DRAWN):
        floor = FloorPlane.from_mount(0.30, math.radians(pitch + 0.02 * number))
        camera = replace(kinect, width=width, height=height, intrinsics=intrinsics, floor=floor)
        frame = SimulatedKinect("paper_room", camera, seed=number).frame()
        images.append(DepthImage.pack(0, 0, "camera", frame, camera, encoding, 1 / 30))
    return images


def measure(variant: str, images: Sequence[DepthImage], robots: int, rate: float, frames: int) -> Run:
    """Let `frames` frames of each robot through."""
    endpoint = free_endpoint()
    names = [f"bench-{uuid.uuid4().hex[:8]}" for _ in range(robots)]
    with ExitStack() as entered:
        started = entered.enter_context(Started())
        started.module("cliffscan", "router", "--listen", endpoint)
        bus = connect(Network("client", [endpoint]), names[0], StopSignal())
        if bus is None:
            raise SystemExit(0)
        entered.enter_context(bus)
        processes = start(variant, started, endpoint, names)
        wait_ready(bus, names)
        return drive([bus.beside(name) for name in names], processes, images, rate, frames)


def start(variant: str, started: Started, endpoint: str, names: Sequence[str]) -> list[psutil.Process]:
    """Start what perceives."""
    if variant == "perception":
        others = [word for name in names[1:] for word in ("--robot", name)]
        where = ["--robot", names[0], *others, "--mode", "client", "--connect", endpoint]
        return [started.module("cliffscan.services.perception", *where)]
    return [started.service(service, name, endpoint) for name in names for service in THREE]


def wait_ready(bus: Bus, names: Sequence[str]) -> None:
    """Wait until the services of all robots work."""
    deadline = time.monotonic() + LATEST
    while any(not set(THREE) <= bus.robots().get(name, set()) for name in names):
        if time.monotonic() > deadline:
            raise SystemExit("the services do not come to life")
        time.sleep(0.1)


def drive(
    buses: Sequence[Bus], processes: Sequence[psutil.Process], images: Sequence[DepthImage], rate: float, frames: int
) -> Run:
    """Publish the frames of all robots, spread evenly over the period, and collect their fused scans."""
    arrived: list[tuple[int, bytes]] = []
    publishers = [bus.publisher(topics.DEPTH) for bus in buses]
    for bus in buses:
        bus.subscribe(topics.SCAN_FUSED.path, lambda _, payload: arrived.append((time.time_ns(), payload)))
    begin = time.monotonic()
    used = began = 0.0
    first = 0
    for number in range((WARM_UP + frames) * len(buses)):
        sequence, robot = divmod(number, len(buses))
        if number == WARM_UP * len(buses):
            used, began, first = sum(map(cpu, processes)), time.monotonic(), time.time_ns()
        time.sleep(max(0.0, begin + number / (rate * len(buses)) - time.monotonic()))
        image = images[(sequence + robot) % len(images)]
        publishers[robot].put(image.model_copy(update={"seq": sequence, "stamp": time.time_ns()}))
    share = (sum(map(cpu, processes)) - used) / (time.monotonic() - began)
    resident = sum(process.memory_info().rss for process in processes) / MIB
    sent = frames * len(buses)
    wait_until(lambda: len(arrived) >= sent + WARM_UP * len(buses), LAST)
    stamps = [(at, LaserScan.decode(payload).stamp) for at, payload in arrived]
    return Run([(at - stamp) * 1e-9 for at, stamp in stamps if stamp >= first], sent, share, resident)


def wait_until(holds: Callable[[], bool], longest: float) -> None:
    """Wait for a fact, but no longer than `longest` [s]."""
    deadline = time.monotonic() + longest
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.01)


def row(variant: str, run: Run, robots: int) -> tuple[str, ...]:
    """A run's figures for people."""
    spread = (f"{1e3 * value:.1f}" for value in np.percentile(run.latencies, (50, 99)))
    shares = f"{100 * run.share:.1f}", f"{100 * run.share / robots:.1f}"
    lost = run.sent - len(run.latencies)
    return (variant, str(run.sent), str(lost), *spread, *shares, f"{run.resident:.0f}")


def main() -> None:
    """Run each variant and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=1)
    parser.add_argument("--rate", type=float, default=30.0, help="[Hz] of each robot")
    parser.add_argument("--frames", type=int, default=300, help="of each robot")
    parser.add_argument("--pitch", type=float, default=1.0, help="[deg] by which the cameras look down")
    parser.add_argument("--compressed", action="store_true", help="send depth compressed")
    parser.add_argument("--only", choices=VARIANTS, help="one variant")
    options = parser.parse_args()
    images = drawn(LEVELS if options.compressed else RAW, options.pitch)
    rows = [
        row(variant, measure(variant, images, options.robots, options.rate, options.frames), options.robots)
        for variant in VARIANTS
        if options.only in (None, variant)
    ]
    kind = "compressed" if options.compressed else "raw"
    title = f"{options.robots} robots, {options.rate:g} Hz, {kind} frame in, fused scan out, {options.pitch:g}° down"
    Console(width=120).print(title, Table(title, HEADINGS, rows).rich())


if __name__ == "__main__":
    main()
