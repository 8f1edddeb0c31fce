"""A great many messages that nobody should send: `python -m benchmarks.hostile --cases 100000 [--services 3000]`.

In one process every reader takes them all; with --services so many go to the real services, and after each batch a good
frame, and a request to the base, has to be answered at once.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import psutil

from tests.hostile import cases
from tests.hostile_readers import Readers
from tests.hostile_services import Trial
from tests.service.conftest import Client

COMPILED = 500  # cases after which every kernel is compiled
SAMPLES = 10  # of the memory
MB = 1e6


def in_process(seed: int, count: int) -> None:
    """Every reader takes all messages."""
    readers, process = Readers(), psutil.Process()
    taken: Counter[str] = Counter()
    all_of: Counter[str] = Counter()
    longest: Counter[str] = Counter()
    memory = []
    for number, case in enumerate(cases(seed, count)):
        name, began = case.kind.__name__, time.perf_counter()
        taken[name] += readers.take(case)
        all_of[name] += 1
        if number > COMPILED:
            longest[name] = max(longest[name], time.perf_counter() - began)
        if number % (count // SAMPLES or 1) == 0:
            memory.append(process.memory_info().rss / MB)
    print("| message | sent | taken | longest [ms] |\n|---|---:|---:|---:|")
    for name, sent in all_of.most_common():
        print(f"| {name} | {sent} | {taken[name]} | {1e3 * longest[name]:.1f} |")
    print(f"memory [MB]: {', '.join(f'{each:.0f}' for each in memory)}")


def to_services(seed: int, count: int) -> None:
    """The real services take them."""
    client, running = Client(), []
    with tempfile.TemporaryDirectory() as folder:
        link = Path(folder) / "kobuki"
        running.append(subprocess.Popen([sys.executable, "-m", "simulator.kobuki", "--link", str(link)]))
        for service in ("negative", "positive", "fuse", "kobuki"):
            where = ["--robot", client.robot, "--mode", "client", "--connect", client.endpoint]
            extra = ["--set", f"kobuki.port={link}"] if service == "kobuki" else []
            running.append(subprocess.Popen([sys.executable, "-m", f"services.{service}", *where, *extra]))
            client.wait_alive(service)
        try:
            told = Trial(client, [process.pid for process in running[1:]]).run(seed, count)
            died = [process.args for process in running if process.poll() is not None]
        finally:
            for process in reversed(running):
                process.terminate()
                process.wait()
            client.session.close()
    print(f"{count} messages: a good frame or a request was answered within {1e3 * told.longest:.0f} ms,")
    print(f"memory grew by {told.growth / MB:.1f} MB at most, died: {died or 'none'}")


def main() -> None:
    """Run both."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hostile", description=__doc__)
    parser.add_argument("--cases", type=int, default=100_000, help="in one process")
    parser.add_argument("--services", type=int, default=0, help="to the real services")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if arguments.cases:
        in_process(arguments.seed, arguments.cases)
    if arguments.services:
        to_services(arguments.seed, arguments.services)


if __name__ == "__main__":
    main()
