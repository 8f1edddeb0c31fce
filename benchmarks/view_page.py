"""How fast a browser draws what `cliffscan view` sends: python -m benchmarks.view_page [--seconds 20]. Needs chromium.

The robot is played here, at 30 Hz with compressed depth and all scans. Latency is from a scan's arrival at the server
to the acknowledgement of its drawn picture, the median of 60 pictures each.
"""

import argparse
import re
import socket
import tempfile
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from typing import Any

from rich.console import Console

from benchmarks.recording import RATE, network, publish, sent
from cliffscan.common.contract.depth_codec import compile_loops
from evaluation.processes.network import free_endpoint
from evaluation.processes.started import cpu
from evaluation.tables import Table
from tests.chromium import Chromium

SCREENS = {"desktop, 1280x900": (1280, 900, 1.0), "phone, 390x844 at 2x": (390, 844, 2.0)}
WARM_UP = 5.0  # [s] left out: the page's own rate is of its last 2 s
LOOK = 1.0  # [s] between two looks at the page
PACE = re.compile(r"(\d+) pictures/s, (\d+) ms")
HEADINGS = ("screen", "pictures/s", "latency ms, median", "worst", "server, CPU %")


def measure(size: tuple[int, int, float], seconds: float, folder: Path) -> tuple[str, str, str, str]:
    """Pictures a second, latencies and CPU of the server while one page looks, as text."""
    with ExitStack() as entered:
        started, bus, where = entered.enter_context(network())
        frames, base = sent(bus)
        port = int(free_endpoint().rpartition(":")[2])
        server = started.module("cliffscan", "view", "--port", str(port), *where)
        browser = Chromium(folder / bus.robot)
        entered.callback(browser.close)
        width, height, scale = size
        browser.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=scale,
            mobile=scale > 1.0,
        )
        while not listens(port):
            time.sleep(0.1)
        browser.call("Page.navigate", url=f"http://127.0.0.1:{port}/")
        playing = threading.Thread(target=publish, args=(frames, base, WARM_UP + seconds + LOOK))
        playing.start()
        time.sleep(WARM_UP)
        used, found = cpu(server), []
        for _ in range(round(seconds / LOOK)):
            time.sleep(LOOK)
            found.append(paces(browser))
        used = cpu(server) - used
        playing.join()
    rates, latencies = zip(*found, strict=True)
    return f"{median(rates):g}", f"{median(latencies):g}", f"{max(latencies):g}", f"{100.0 * used / seconds:.0f}"


def listens(port: int) -> bool:
    """Whether the page is served."""
    with socket.socket() as tried:
        return tried.connect_ex(("127.0.0.1", port)) == 0


def paces(browser: Any) -> tuple[int, int]:  # noqa: ANN401
    """Pictures a second and latency [ms], as the page shows them."""
    text = browser.value("document.getElementById('pace').textContent")
    found = PACE.fullmatch(text)
    if found is None:
        raise SystemExit(f"the page shows {text!r}, expected its pace")
    return int(found[1]), int(found[2])


def main() -> None:
    """Run both screens and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=20.0)
    options = parser.parse_args()
    compile_loops()  # or the first pictures wait for the server to do it
    with tempfile.TemporaryDirectory() as folder:
        rows = [(name, *measure(size, options.seconds, Path(folder))) for name, size in SCREENS.items()]
    Console(width=100).print(f"The page at {RATE:g} scans a second", Table("", HEADINGS, rows).rich())


if __name__ == "__main__":
    main()
