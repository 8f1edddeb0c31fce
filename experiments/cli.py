"""The command line of the experiments."""

import argparse
import logging
from pathlib import Path
from typing import get_args

from rich.console import Console

from cliffscan.cli import VIEW_PORT
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.network import BusError
from cliffscan.common.runtime.service import USAGE_ERROR
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.supervisor import ConfigRefused
from evaluation.processes.steering import Step, To
from evaluation.processes.watch import Failed
from experiments.map_system import Mapper
from experiments.mapping import ROUND, run_mapping
from experiments.recording import run_recording
from experiments.run import Run
from experiments.watched import run_view
from experiments.worlds import run_worlds

WORLDS = ("paper_room", "paper_room_open")  # figures 11 to 13, 17, 18, 21; 14 to 16, 19, 20, 22
INTERRUPTED = 130
DESCRIPTION = "The paper's experiments through the real services, or the scans of a recording."


def build_parser() -> argparse.ArgumentParser:
    """All options."""
    parser = argparse.ArgumentParser(prog="demo", description=DESCRIPTION)
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--data", type=Path, metavar="PATH", help="a depth folder, ROS bag or MCAP file to draw")
    what.add_argument("--world", action="append", metavar="NAME", help="a simulated world (default: the paper's two)")
    what.add_argument("--map", action="store_true", help="the mapping experiment only")
    parser.add_argument("--frames", type=positive, default=30, metavar="N", help="frames of each world (default 30)")
    parser.add_argument("--slam", choices=get_args(Mapper), default="odometry_map", help="what maps (%(default)s)")
    parser.add_argument("--route", type=route, default=ROUND, metavar="'X,Y ...'", help="way points [m] of the drive")
    parser.add_argument(
        "--view",
        type=positive,
        nargs="?",
        const=VIEW_PORT,
        metavar="PORT",
        help="leave a page open on the drive when all is done, until Ctrl-C (default port %(const)s)",
    )
    text = "with keys made for it, the robot and the workstation each behind a router of its own"
    parser.add_argument("--secure", action="store_true", help=text)
    parser.add_argument(
        "--out", type=Path, default=Path("out"), metavar="DIR", help="where to write (default: out beside demo)"
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="SERVICE.KEY=VALUE", help="override a service's configuration"
    )
    return parser


def positive(text: str) -> int:
    """A number of at least one."""
    number = int(text) if text.isdecimal() else 0
    if not number:
        raise argparse.ArgumentTypeError(f"expected a whole number above 0, got {text!r}")
    return number


def route(text: str) -> list[Step]:
    """Way points: pairs of numbers, as `0.5,0 0.5,-1`."""
    places = [word.split(",") for word in text.split()]
    if not places or any(len(place) != 2 for place in places):
        raise argparse.ArgumentTypeError(f"expected X,Y pairs, got {text!r}")
    return [To(float(x), float(y)) for x, y in places]


def main() -> None:
    """Run the experiments; leaves with the exit code."""
    parser = build_parser()
    arguments = parser.parse_args()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s demo: %(message)s")
    if arguments.secure and arguments.data and not arguments.view:
        parser.error("--secure: a recording is read without any network; leave one of them out")
    stop = StopSignal()
    run = Run(Console(), stop, arguments.out, arguments.set, arguments.secure)
    try:
        arguments.out.mkdir(parents=True, exist_ok=True)
        run.log_file.write_text("")
    except OSError as error:
        parser.error(f"--out: {error}")
    try:
        if arguments.data:
            run_recording(run, arguments.data)
        else:
            if not arguments.map:
                run_worlds(run, arguments.world or WORLDS, arguments.frames)
            if not arguments.world:
                run_mapping(run, arguments.route, arguments.slam)
        if arguments.view and not stop.is_set():
            run_view(run, arguments.route, arguments.slam, arguments.view)
            return
    except ConfigRefused:
        parser.exit(USAGE_ERROR)  # the service has said why
    except (ConfigError, BusError) as error:
        parser.exit(USAGE_ERROR, f"demo: {error}\n")
    except Failed as error:
        parser.exit(1, f"demo: {error}; everything has been ended; the services' own words: {run.log_file}\n")
    except SystemExit:
        if not stop.is_set():
            raise
    if stop.is_set():
        parser.exit(INTERRUPTED, "demo: interrupted; everything has been ended\n")
