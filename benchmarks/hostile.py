"""A great many messages that nobody should send: `python -m benchmarks.hostile --cases 100000 [--services 3000]`.

In one process every reader takes them all; with --services so many go to the real services, and after each batch a good
frame, and a request to the base, has to be answered at once.
"""

import argparse
import tempfile
import time
from collections import Counter, defaultdict
from pathlib import Path

import psutil

from evaluation.processes.started import Started
from evaluation.tables import Table
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
    longest: dict[str, float] = defaultdict(float)
    memory = []
    for number, case in enumerate(cases(seed, count)):
        name, began = case.kind.__name__, time.perf_counter()
        taken[name] += readers.take(case)
        all_of[name] += 1
        if number > COMPILED:
            longest[name] = max(longest[name], time.perf_counter() - began)
        if number % (count // SAMPLES or 1) == 0:
            memory.append(process.memory_info().rss / MB)
    rows = [(name, str(sent), str(taken[name]), f"{1e3 * longest[name]:.1f}") for name, sent in all_of.most_common()]
    note = f"memory [MB]: {', '.join(f'{each:.0f}' for each in memory)}"
    print(Table("Hostile messages", ("message", "sent", "taken", "longest [ms]"), rows, note=note).markdown())


def to_services(seed: int, count: int) -> None:
    """The real services take them."""
    client = Client()
    with tempfile.TemporaryDirectory() as folder, Started() as started:
        link = Path(folder) / "kobuki"
        started.module("cliffscan.simulator.kobuki", "--link", link)
        services = []
        for name in ("negative", "positive", "fuse", "kobuki"):
            settings = [f"kobuki.port={link}"] if name == "kobuki" else []
            services.append(started.service(name, client.robot, client.endpoint, *settings))
            client.wait_alive(name)
        told = Trial(client, [process.pid for process in services]).run(seed, count)
        died = started.died
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
