"""The services on two hosts over emulated links, as root: python -m benchmarks.link [--links NAME ...] [--tcp NAME ...]

Robot and workstation are network namespaces of this machine. The robot, simulated, drives in a circle by commands that
come from the workstation. `fused` is what arrives at the robot; `no scan` is the share of the time in which its gate
held it for want of a fresh one.
"""

import argparse
import logging
import signal
import sys
from collections.abc import Mapping
from pathlib import Path

from benchmarks.link.figures import Figures
from benchmarks.link.hosts import Hosts, NoHosts
from benchmarks.link.path import Link
from benchmarks.link.split import NotStarted, Split, Variant
from evaluation.processes.service_log import ServiceLog
from evaluation.tables import Table, number, percent

PIPELINE = "negative", "positive", "fuse"
LINKS: Mapping[str, Link] = {
    "good": Link(200e6, delay=0.001),
    "20": Link(20e6, delay=0.005, jitter=0.003, loss=0.01),
    "6": Link(6e6, delay=0.020, loss=0.02),
    "2": Link(2e6, delay=0.050),
}
VARIANTS: Mapping[str, Variant] = {
    "three": Variant(workstation=PIPELINE),
    "workstation": Variant(workstation=["perception"]),
    "robot": Variant(robot=["perception"]),
    "both": Variant(robot=["perception"], beside=True),
}
OUT = Path("out/link.md")
HEADINGS = ("link", "perception", "TCP", "fused Hz", "p50 ms", "p99 ms", "longest gap s", "no scan", "odometry lost",
            "late ms", "doubled", "kB/s up")  # fmt: skip


def arguments() -> argparse.Namespace:
    """The options."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.link", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--links", nargs="+", choices=LINKS, default=[*LINKS], help="Mbit/s; all, if none")
    parser.add_argument("--perception", nargs="+", choices=VARIANTS, default=[*VARIANTS], help="where it runs; all")
    parser.add_argument(
        "--tcp", nargs="+", default=["reno"], metavar="NAME", help="congestion controls, as cubic, reno, bbr; reno"
    )
    parser.add_argument("--capture", nargs="+", default=[], metavar="KEY=VALUE", help="settings of capture")
    parser.add_argument("--seconds", type=float, default=20.0, help="of each run (20)")
    parser.add_argument("--settling", type=float, default=8.0, help="[s] before each run (8)")
    parser.add_argument("--outage", type=float, default=0.0, help="[s] for which the link is down in each run (0)")
    parser.add_argument("--rate", type=float, default=30.0, help="[Hz] of the frames (30)")
    parser.add_argument("--out", type=Path, default=OUT, help=f"file of the table ({OUT})")
    return parser.parse_args()


def cells(found: Figures) -> list[str]:
    """The figures as text."""
    times = [number(1e3 * value, ".0f") for value in (found.median, found.percentile99)]
    lost = percent(found.no_scan), percent(found.odometry_lost), number(1e3 * found.odometry_late, ".0f")
    return [number(found.rate, ".1f"), *times, number(found.gap, ".2f"), *lost, str(found.doubled),
            number(found.up / 1e3, ".0f")]  # fmt: skip


def runs(asked: argparse.Namespace) -> list[list[str]]:
    """A row for each run. Raises NoHosts, NotStarted."""
    rows = []
    for tcp in asked.tcp:
        for name in asked.perception:
            variant = VARIANTS[name]._replace(capture=asked.capture)
            with Hosts(tcp) as hosts, Split(hosts, variant, asked.rate) as split:
                for link in asked.links:
                    found = split.measure(LINKS[link], asked.settling, asked.seconds, asked.outage)
                    rows.append([link, name, tcp, *cells(found)])
                    print(*rows[-1], sep="\t", flush=True)
    return rows


def main() -> None:
    """Measure, and write the table."""
    asked = arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what was started ends, too
    logging.basicConfig(level=logging.ERROR)
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    log = asked.out.with_suffix(".log")
    log.write_text("")
    try:
        with ServiceLog(log):
            rows = runs(asked)
    except (NoHosts, NotStarted) as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from error
    table = Table("links", HEADINGS, rows, 3)
    asked.out.write_text(f"{table.markdown()}\n", encoding="utf-8")
    print(table.markdown())


if __name__ == "__main__":
    main()
