"""What the ROS 2 node costs with everything but images subscribed: `python -m benchmarks.ros2_node`.

A robot's messages are published at their rates, its scans as they are in a simulated room. Printed are the time from
the fused scan's arrival at a program to that of `/scan` at the same program, and the node's share of a core.
"""

import argparse
import struct
import time
from collections.abc import Callable
from functools import partial

import msgpack
import numpy as np
import zenoh
from rich.console import Console

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.ros2 import interfaces
from cliffscan.services.ros2.interfaces import Interface
from cliffscan.simulator.camera import SimulatedKinect
from evaluation.processes.started import Started, cpu
from evaluation.tables import Table
from tests.service.conftest import Client

WARM_UP = 3.0  # [s]
TICK = 0.005  # [s] between two looks at what is due
SUBSCRIBED: dict[str, Interface] = {
    "scan": interfaces.LASER_SCAN,
    "scan_marks": interfaces.LASER_SCAN,
    "scan_clear": interfaces.LASER_SCAN,
    "cliff_points": interfaces.POINT_CLOUD,
    "odom": interfaces.ODOMETRY,
    "tf": interfaces.TF_MESSAGE,
    "tf_static": interfaces.TF_MESSAGE,
    "robot_description": interfaces.STRING,
    "imu/data": interfaces.IMU,
    "battery_state": interfaces.BATTERY_STATE,
    "diagnostics": interfaces.DIAGNOSTIC_ARRAY,
    "map": interfaces.OCCUPANCY_GRID,
}
HEADINGS = ("messages a second", "scans", "p50 [ms]", "p99 [ms]", "of a core [%]")


def fused_scan() -> LaserScan:
    """A scan of the simulated room."""
    kinect = SimulatedKinect("paper_room")
    image = DepthImage.pack(0, 0, "camera", kinect.frame(), kinect.camera, "16UC1", 1 / 30)
    return perceive(image, Settings()).fused


def streams() -> dict[str, tuple[float, Callable[[int], bytes]]]:
    """What a robot publishes: a rate [Hz] and the payload of a stamp [ns] by path."""
    scan, matrix, two, three = fused_scan(), [0.0] * 9, [False] * 2, [False] * 3

    def packed(fields: dict[str, object]) -> Callable[[int], bytes]:
        return lambda stamp: bytes(msgpack.packb({"stamp": stamp, **fields}))

    odometry = {"frame": "odom", "child_frame": "base_link", "pose": [1.0, 2.0, 0.5], "twist": [0.2, 0.0]}
    gyro = {"frame": "gyro_link", "heading": 0.5, "heading_rate": 0.1, "sample_stamps": [], "angular_velocities": b""}
    state = {
        "bumpers": three, "cliffs": three, "cliff_counts": [2000] * 3, "wheel_drops": two, "overcurrents": two,
        "currents": [0.1, 0.1], "buttons": three, "battery_voltage": 16.0, "battery_percent": 80.0,
        "charger": "discharging", "dock_ir": [0] * 3, "digital_inputs": [False] * 4, "analog_inputs": [0.0] * 4,
    }  # fmt: skip
    rule = {"rule": "free", "distance": -1.0, "latched": False, "note": ""}
    status = {
        "version": "1", "state": "working", "pid": 1, "uptime": 5.0, "rate": 30.0, "latency": [0.01, 0.02],
        "counts": {"received": 100}, "note": "",
    }  # fmt: skip
    return {
        "scan/fused": (30.0, lambda stamp: scan.model_copy(update={"stamp": stamp}).encode()),
        "base/odom": (50.0, packed({**odometry, "pose_covariance": matrix, "twist_covariance": matrix})),
        "base/state": (50.0, packed(state)),
        "base/imu": (50.0, packed(gyro)),
        "base/safety": (1.0, packed({**rule, "asked": [0.2, 0.0], "allowed": [0.2, 0.0]})),
        **{f"status/{name}": (1.0, packed({"service": name, **status})) for name in ("capture", "fuse", "kobuki")},
    }


def publish(client: Client, seconds: float) -> None:
    """Publish all streams for so long [s]."""
    begun, rows = time.monotonic(), streams()
    sent = dict.fromkeys(rows, 0)
    while (now := time.monotonic() - begun) < seconds:
        for path, (rate, payload) in rows.items():
            if sent[path] <= now * rate:
                sent[path] += 1
                client.put(path, payload(time.time_ns()))
        time.sleep(TICK)


def stamp_of(payload: bytes) -> int:
    """The stamp [ns] of a ROS message that begins with a header."""
    seconds, nanoseconds = struct.unpack_from("<iI", payload, 4)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


def measure(seconds: float) -> tuple[str, ...]:
    """A run's figures for people."""
    client = Client()
    fused: list[tuple[int, bytes]] = []
    scans: list[tuple[int, bytes]] = []
    counts = [0]

    def on_fused(sample: zenoh.Sample) -> None:
        fused.append((time.monotonic_ns(), sample.payload.to_bytes()))

    def on_ros(topic: str, sample: zenoh.Sample) -> None:
        counts[0] += 1
        if topic == "scan":
            scans.append((time.monotonic_ns(), sample.payload.to_bytes()))

    client.session.declare_subscriber(f"{client.robot}/scan/fused", on_fused)
    with Started() as started:
        process = started.service("ros2", client.robot, client.endpoint)
        client.wait_alive("ros2")
        for topic, interface in SUBSCRIBED.items():
            key = f"0/{topic}/{interface.dds_name}/{interface.type_hash}"
            client.session.declare_subscriber(key, partial(on_ros, topic))
        publish(client, WARM_UP)
        fused.clear()
        counts[0], used, begun = 0, cpu(process), time.monotonic()
        publish(client, seconds)
        lasted = time.monotonic() - begun
        share = (cpu(process) - used) / lasted
    client.session.close()  # or the process would not end
    arrived = {msgpack.unpackb(payload)["stamp"]: at for at, payload in fused}
    pairs = [(at, arrived.get(stamp_of(payload))) for at, payload in scans]
    delays = [1e-6 * (at - before) for at, before in pairs if before is not None]
    spread = (f"{delay:.2f}" for delay in np.percentile(delays, (50, 99)))
    return (f"{counts[0] / lasted:.0f}", str(len(delays)), *spread, f"{100 * share:.1f}")


def main() -> None:
    """Measure some runs, for a busy machine differs from one to the next."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ros2_node", description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="of each run")
    parser.add_argument("--runs", type=int, default=3)
    asked = parser.parse_args()
    rows = [measure(asked.seconds) for _ in range(asked.runs)]
    Console().print(Table("/scan behind scan/fused, all but images subscribed", HEADINGS, rows).rich())


if __name__ == "__main__":
    main()
