"""How long a `stop` waits while another client floods the base's service: `python -m benchmarks.flood`.

The flood asks for `version` and publishes `base/cmd_vel`, as fast as it is told; `stop` is asked every 50 ms.
"""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
from rich.console import Console

from benchmarks.faults.intruder import COMMANDS, REQUESTS, Intrusion
from evaluation.processes.started import Started
from evaluation.tables import Table
from tests.service.conftest import Client

EVERY = 0.05  # [s] between two questions
WARM_UP = 1.0  # [s] of the flood
HEADINGS = ("", "asked", "p50 [ms]", "p99 [ms]", "longest [ms]")


def row(name: str, client: Client, seconds: float) -> tuple[str, ...]:
    """How long a `stop` waited for its answer, asked again and again for that long [s]."""
    waits, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        began = time.monotonic()
        if not client.ask("base/command/stop", {})["ok"]:
            raise SystemExit("a stop was refused")
        waits.append(1e3 * (time.monotonic() - began))
        time.sleep(EVERY)
    return name, str(len(waits)), *(f"{wait:.1f}" for wait in np.percentile(waits, (50, 99, 100)))


def main() -> None:
    """Measure without the flood and in it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.flood", description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="of each measurement")
    parser.add_argument("--gets", type=float, default=REQUESTS, help="requests for `version` a second")
    parser.add_argument("--puts", type=float, default=COMMANDS, help="commands on `base/cmd_vel` a second")
    asked, client = parser.parse_args(), Client()
    with tempfile.TemporaryDirectory() as folder, Started() as started:
        link = Path(folder) / "kobuki"
        started.module("cliffscan.simulator.kobuki", "--link", link)
        started.service("kobuki", client.robot, client.endpoint, f"kobuki.port={link}")
        client.wait_alive("kobuki")
        rows = [row("quiet", client, asked.seconds)]
        with Intrusion("flood", client.robot, client.endpoint, asked.puts, asked.gets) as flood:
            flood.release()
            time.sleep(WARM_UP)
            rows.append(row(f"{asked.gets:g} gets/s, {asked.puts:g} puts/s", client, asked.seconds))
    client.session.close()  # or the process would not end
    Console().print(Table("stop in a flood", HEADINGS, rows).rich())


if __name__ == "__main__":
    main()
