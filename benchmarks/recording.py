"""What `cliffscan record` costs while a robot publishes all it can: python -m benchmarks.recording [--seconds 20].

The robot is played here: noisy depth images with the scans made of them at 30 Hz; odometry, state and gyro at 50 Hz.
"""

import argparse
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import BaseState, Imu, Odometry
from cliffscan.common.contract.beam_fields import ABSENT
from cliffscan.common.contract.depth_codec import LEVELS
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.service import connect
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.kinect import kinect_camera
from evaluation.processes.network import free_endpoint
from evaluation.processes.started import Started, cpu
from evaluation.tables import Table

RATE, BASE_RATE = 30.0, 50.0  # [Hz]
DRAWN = 32  # different frames, each of which comes again and again, but none twice in what is compressed at once
WARM_UP = 3.0  # [s] left out, once the recorder has begun
MIB = 2**20
VARIANTS: dict[str, Sequence[str]] = {
    "camera/depth alone": ("--keys", "camera/depth", "--images", "0"),
    "all, native samples alone": ("--no-ros",),
    "all, ROS topics but images": ("--images", "0"),
    "all, and an image a second": (),
}
HEADINGS = ("recorded", "CPU % of a core", "MB/s", "resident MiB")
ZEROS = [0.0] * 9


def sent(bus: Bus) -> tuple[list[Callable[[], object]], list[Callable[[], object]]]:
    """What publishes one camera frame of several with its scans, and one turn of the base."""

    def frame(number: int) -> Callable[[], object]:
        camera = kinect_camera()
        depth = SimulatedKinect("paper_room", camera, seed=number).frame()
        image = DepthImage.pack(number, time.time_ns(), "camera", depth, camera, LEVELS, 1 / RATE)
        scans = perceive(image, Settings())
        puts: list[tuple[Any, Any]] = [
            (depth_out, image),
            (positive, scans.positive),
            (negative, scans.negative),
            (near_edge, scans.by_method["near_edge"]),
            (fused, scans.fused),
        ]

        def put() -> None:
            fresh = {"stamp": time.time_ns()}
            for publisher, message in puts:
                publisher.put(message.model_copy(update=fresh))

        return put

    depth_out = bus.publisher(topics.DEPTH)
    positive, negative = bus.publisher(topics.SCAN_POSITIVE), bus.publisher(topics.SCAN_NEGATIVE)
    near_edge, fused = bus.publisher(topics.SCAN_OF_METHOD.named("near_edge")), bus.publisher(topics.SCAN_FUSED)
    odometry, state, gyro = bus.publisher(topics.ODOMETRY), bus.publisher(topics.BASE_STATE), bus.publisher(topics.IMU)
    return [frame(number) for number in range(DRAWN)], [
        lambda: odometry.put(
            Odometry(
                stamp=time.time_ns(),
                frame="odom",
                child_frame="base_link",
                pose=(1.0, 2.0, 0.5),
                twist=(0.2, 0.0),
                pose_covariance=ZEROS,
                twist_covariance=ZEROS,
            )
        ),
        lambda: state.put(
            BaseState(
                stamp=time.time_ns(),
                bumpers=(False,) * 3,
                cliffs=(False,) * 3,
                cliff_counts=(2000,) * 3,
                wheel_drops=(False,) * 2,
                overcurrents=(False,) * 2,
                currents=(0.1, 0.1),
                buttons=(False,) * 3,
                battery_voltage=15.0,
                battery_percent=80.0,
                charger="discharging",
                dock_ir=(0,) * 3,
                digital_inputs=(False,) * 4,
                analog_inputs=(0.0,) * 4,
            )
        ),
        lambda: gyro.put(
            Imu(
                stamp=time.time_ns(),
                frame="gyro_link",
                heading=0.5,
                heading_rate=0.0,
                sample_stamps=[],
                angular_velocities=ABSENT,
            )
        ),
    ]


@contextmanager
def network() -> Iterator[tuple[Started, Bus, list[str]]]:
    """A router, a robot on it, and the options by which others connect to them."""
    endpoint, robot = free_endpoint(), f"bench-{uuid.uuid4().hex[:8]}"
    with Started() as started:
        started.module("cliffscan", "router", "--listen", endpoint)
        bus = connect(Network("client", [endpoint]), robot, StopSignal())
        if bus is None:
            raise SystemExit(0)
        with bus:
            yield started, bus, ["--robot", robot, "--mode", "client", "--connect", endpoint]


def measure(options: Sequence[str], seconds: float, folder: Path) -> tuple[str, str, str]:
    """CPU, bytes and memory of a recorder with these options, as text."""
    with network() as (started, bus, where):
        file = folder / f"{bus.robot}.mcap"
        frames, base = sent(bus)
        process = started.module("cliffscan", "record", file, *where, *options)
        while not file.exists():
            time.sleep(0.1)
        publish(frames, base, WARM_UP)
        used, size, begun = cpu(process), file.stat().st_size, time.monotonic()
        publish(frames, base, seconds)
        passed = time.monotonic() - begun
        share = 100.0 * (cpu(process) - used) / passed
        rate = (file.stat().st_size - size) / passed / 1e6
        return f"{share:.1f}", f"{rate:.2f}", f"{process.memory_info().rss / MIB:.0f}"


def publish(frames: Sequence[Callable[[], object]], base: Sequence[Callable[[], object]], seconds: float) -> None:
    """Publish at RATE and BASE_RATE for so long [s]."""
    begun = time.monotonic()
    pictures = turns = 0
    while (now := time.monotonic() - begun) < seconds:
        if pictures <= now * RATE:
            frames[pictures % len(frames)]()
            pictures += 1
        if turns <= now * BASE_RATE:
            for put in base:
                put()
            turns += 1
        time.sleep(max(0.0, min(pictures / RATE, turns / BASE_RATE) - (time.monotonic() - begun)))


def main() -> None:
    """Run each variant and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=20.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [(name, *measure(words, options.seconds, Path(folder))) for name, words in VARIANTS.items()]
    title = f"Recording at {RATE:g} Hz"
    Console(width=100).print(title, Table(title, HEADINGS, rows).rich())


if __name__ == "__main__":
    main()
