"""How long one frame takes, by method and beside a plain NumPy version: python -m benchmarks.speed [--frames N].

All are measured in one run, in turn, so that a busy machine is as hard on one as on the other, and in processor time,
which stands still while others run. Each is measured after a sleep of 33 ms, as a service lives: its data and code have
left the processor's caches meanwhile. `--rest 0` leaves the sleep out.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from statistics import median
from time import perf_counter, sleep, thread_time

import numpy as np
from rich.console import Console

from cliffscan.common.contract import depth_codec
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import FloorPlane, scan_axes
from cliffscan.common.contract.depth_codec import LEVELS, RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import combine
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.negative.scans import beams_by_method
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.scan import positive_scan
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.kinect import KinectModel, kinect_camera
from evaluation.tables import Table

LEVEL = (0.0, 0.0)  # pitch and roll [deg]
WORLDS = {
    "paper_room": LEVEL,
    "stairs_corridor": LEVEL,
    "empty_room": LEVEL,
    "paper_room, 1° down": (1.0, 0.5),
    "paper_room, 20° down": (20.0, 2.0),
}
REST = 33.0  # [ms] between two frames at 30 Hz
PAPER = NegativeConfig(methods=("farthest_point", "virtual_floor"))
OURS = NegativeConfig(methods=("near_edge",))
ALL = NegativeConfig(methods=tuple(METHODS))
POSITIVE = PositiveConfig()
COLD = """
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.scans import negative_scans
negative_scans(WARMUP_IMAGE, NegativeConfig())
"""


def image_of(world: str, pitch: float, roll: float) -> DepthImage:
    """A noisy frame of a world, by a camera 0.30 m high that looks `pitch` [deg] down and leans to its right."""
    floor = FloorPlane.from_mount(0.30, np.radians(pitch), np.radians(roll))
    camera = replace(kinect_camera(), floor=floor)
    frame = SimulatedKinect(world, camera, KinectModel(dropout=0.05), seed=1).frame()
    return DepthImage.pack(0, 0, "camera", frame, camera, RAW)


def plain_numpy(image: DepthImage, grid: Grid, band: float, robot_height: float) -> None:
    """The paper's methods and the positive scan as one would write them first, in whole-image operations."""
    forward, left, up = (axis.table() for axis in scan_axes(image.camera))
    depth = image.depth * 0.001
    height = depth * up + image.camera.floor.d
    distance = np.hypot(forward, left) * depth
    beam = grid.beam_of(np.arctan2(left, forward))
    near, far = image.camera.range
    seen = (depth >= near) & (depth <= far) & (beam >= 0) & (beam < grid.beams)
    floor, below = seen & (np.abs(height) <= band), seen & (height < -band)
    standing = seen & (height > band) & (height <= robot_height)
    farthest, nearest, positive = np.zeros(grid.beams), np.full(grid.beams, np.inf), np.full(grid.beams, np.inf)
    np.maximum.at(farthest, beam[floor], distance[floor])
    drop = image.camera.floor.d
    np.minimum.at(nearest, beam[below], distance[below] * drop / (drop - height[below]))
    np.minimum.at(positive, beam[standing], distance[standing])
    np.minimum(np.minimum(farthest, nearest), positive)


def moving(image: DepthImage) -> Callable[[], object]:
    """The default methods on frames of which each has another floor plane near its own, as a tracker gives them."""
    height, pitch, roll = image.camera.floor.mount()
    planes = (FloorPlane.from_mount(height, pitch + 1e-6 * step, roll) for step in count())

    def work() -> None:
        camera = replace(image.camera, floor=next(planes))
        moved = DepthImage.pack(0, 0, "camera", image.depth, camera, RAW)
        perceive(moved, Settings(OURS, POSITIVE))

    return work


def jobs(image: DepthImage) -> dict[str, Callable[[], object]]:
    """What is measured, by name."""
    seen = floor_points(image.depth, image.camera, ALL.range_min, ALL.floor_band)
    tracker = FloorTracker(image.camera.floor)
    data = depth_codec.encode(image.depth, LEVELS)
    beams = list(beams_by_method(image, ALL, ALL.methods).values())

    def fused(config: NegativeConfig) -> Callable[[], object]:
        return lambda: perceive(image, Settings(config, POSITIVE))

    return {
        "heights and distances": lambda: floor_points(image.depth, image.camera, ALL.range_min, ALL.floor_band),
        **{method: partial(METHODS[method].find, seen, ALL) for method in ALL.methods},
        "positive, all of it": lambda: positive_scan(image, POSITIVE),
        "combine all methods": lambda: combine(beams),
        "default: near_edge + positive + fuse": fused(OURS),
        "floor tracker": lambda: tracker.update(image.depth, image.camera),
        "default, another floor plane in each frame": moving(image),
        "paper: both methods + positive + fuse": fused(PAPER),
        "everything: all methods + positive + fuse": fused(ALL),
        "paper in plain NumPy": lambda: plain_numpy(image, ALL.grid(), ALL.floor_band, POSITIVE.robot_height),
        "depth to bytes": lambda: depth_codec.encode(image.depth, LEVELS),
        "bytes to depth": partial(depth_codec.decode, data, LEVELS, image.width, image.height),
    }


def medians(work: dict[str, Callable[[], object]], frames: int, rest: float) -> dict[str, float]:
    """Median processor time [ms] of each, all of them in turn, each after a `rest` [ms]."""
    taken: dict[str, list[float]] = {name: [] for name in work}
    for each in work.values():
        each()
    for _ in range(frames):
        for name, each in work.items():
            sleep(rest / 1000.0)
            start = thread_time()
            each()
            taken[name].append(thread_time() - start)
    return {name: 1000.0 * median(times) for name, times in taken.items()}


def cold_start() -> float:
    """Time [s] until a fresh process has its first result, with no kernel compiled before."""
    with tempfile.TemporaryDirectory() as empty:
        start = perf_counter()
        subprocess.run([sys.executable, "-c", COLD], check=True, env={**os.environ, "NUMBA_CACHE_DIR": empty})
        return perf_counter() - start


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--rest", type=float, default=REST, help="[ms] of sleep before each measurement")
    options = parser.parse_args()
    columns = {
        name: medians(jobs(image_of(name.partition(",")[0], *mount)), options.frames, options.rest)
        for name, mount in WORLDS.items()
    }
    rows = [(name, *(f"{column[name]:.3f}" for column in columns.values())) for name in next(iter(columns.values()))]
    console = Console(width=150)
    cache = f"after {options.rest:g} ms of sleep" if options.rest else "with warm caches"
    console.print(Table("", (f"one frame of 640 x 480, median ms {cache}", *columns), rows).rich())
    console.print(f"first result of a fresh process without compiled kernels: {cold_start():.1f} s")


if __name__ == "__main__":
    main()
