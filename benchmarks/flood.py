"""How long a `stop` waits while another client floods the base's service: `python -m benchmarks.flood`.

The flood asks for `version` and puts `base/cmd_vel`, as fast as it is told; `stop` is asked every 50 ms.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import msgpack
import numpy as np
import zenoh

ROBOT = "flooded"
ENDPOINT = "tcp/127.0.0.1:17651"
PATIENCE = 10.0  # [s] for one answer
EVERY = 0.05  # [s] between two questions
CHUNK = 0.002  # [s] between two bursts of the flood


def session(mode: str) -> zenoh.Session:
    """A plain session: on the private router, or that router itself."""
    config = zenoh.Config()
    config.insert_json5("mode", json.dumps(mode))
    config.insert_json5("listen/endpoints" if mode == "router" else "connect/endpoints", json.dumps([ENDPOINT]))
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def flood(gets: float, puts: float) -> None:
    """Ask and put at these rates [Hz] until killed."""
    with session("client") as flooding:
        asker = flooding.declare_querier(f"{ROBOT}/base/command/version")
        publisher = flooding.declare_publisher(f"{ROBOT}/base/cmd_vel")
        began, asked, said = time.monotonic(), 0, 0
        while True:
            passed = time.monotonic() - began
            for _ in range(int(gets * passed) - asked):
                asker.get(zenoh.handlers.RingChannel(1))
            asked = int(gets * passed)
            velocity = msgpack.packb({"stamp": time.time_ns(), "linear": 0.1, "angular": 0.0})
            for _ in range(int(puts * passed) - said):
                publisher.put(velocity)
            said = int(puts * passed)
            time.sleep(CHUNK)


def answers(asking: zenoh.Session, seconds: float) -> list[float]:
    """Seconds until each of the `stop`s was answered; PATIENCE where none came."""
    waits, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        began = time.monotonic()
        replies = asking.get(f"{ROBOT}/base/command/stop", timeout=PATIENCE)
        came = any(reply.ok and msgpack.unpackb(reply.ok.payload.to_bytes())["ok"] for reply in replies)
        waits.append(time.monotonic() - began if came else PATIENCE)
        time.sleep(EVERY)
    return waits


def ready(asking: zenoh.Session, service: str) -> None:
    """Wait until a service holds its token."""
    while not any(reply.ok for reply in asking.liveliness().get(f"{ROBOT}/alive/{service}", timeout=1.0)):
        time.sleep(EVERY)


def tell(name: str, waits: list[float]) -> None:
    """One line of the table."""
    p50, p99 = 1e3 * np.percentile(waits, (50, 99))
    print(f"| {name} | {len(waits)} | {p50:.1f} | {p99:.1f} | {1e3 * max(waits):.1f} |")


def measure(arguments: argparse.Namespace) -> None:
    """The table of waits, without the flood and in it."""
    python, link = [sys.executable, "-m"], Path(tempfile.mkdtemp()) / "kobuki"
    service = ["services.kobuki", "--robot", ROBOT, "--mode", "client", "--connect", ENDPOINT]
    flooding = ["benchmarks.flood", "--flood", "--gets", str(arguments.gets), "--puts", str(arguments.puts)]
    with session("router"), session("client") as asking:
        running = [subprocess.Popen([*python, "simulator.kobuki", "--link", str(link)])]
        try:
            running.append(subprocess.Popen([*python, *service, "--set", f"kobuki.port={link}"]))
            ready(asking, "kobuki")
            print("| | asked | p50 [ms] | p99 [ms] | longest [ms] |\n|---|---:|---:|---:|---:|")
            tell("quiet", answers(asking, arguments.seconds))
            running.append(subprocess.Popen([*python, *flooding]))
            time.sleep(1.0)
            tell(f"{arguments.gets:g} gets/s, {arguments.puts:g} puts/s", answers(asking, arguments.seconds))
        finally:
            for process in reversed(running):
                process.terminate()
                process.wait()


def main() -> None:
    """Measure, or be the flood."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.flood", description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="of each measurement")
    parser.add_argument("--gets", type=float, default=20_000.0, help="requests for `version` a second")
    parser.add_argument("--puts", type=float, default=5_000.0, help="commands on `base/cmd_vel` a second")
    parser.add_argument("--flood", action="store_true", help="be the flood")
    arguments = parser.parse_args()
    if arguments.flood:
        flood(arguments.gets, arguments.puts)
    else:
        measure(arguments)


if __name__ == "__main__":
    main()
