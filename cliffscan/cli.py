"""The command line of `cliffscan`."""

import argparse
import logging
import math
import re
import socket
import sys
from collections.abc import Callable
from pathlib import Path
from typing import get_args

from cliffscan.calibrate import calibrate
from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime import options
from cliffscan.common.runtime.bus import Bus, BusError, Network
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.service import USAGE_ERROR, StopSignal, connect, package_version
from cliffscan.drive import PRIORITY, drive
from cliffscan.echo import echo
from cliffscan.listing import list_keys, list_robots
from cliffscan.live import alive
from cliffscan.run import add_run
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.open_source import installed
from cliffscan.simulator.world_names import RANDOM, world_names
from cliffscan.status import status
from cliffscan.supervisor import ConfigRefused
from cliffscan.system import TURN, Base, Plan, System
from cliffscan.welcome import welcome

SIMULATED = "simulated"
WORLD = "paper_room"  # has a hole 1.5 m ahead

HOST = re.sub(r"[^A-Za-z0-9_.-]", "_", socket.gethostname()) or "here"

log = logging.getLogger("cliffscan")


def up(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Run everything until Ctrl-C."""
    plan = plan_of(arguments)
    if arguments.dump_config:
        plan.check()
        sys.stdout.write(plan.dump())
        return 0
    with System(plan, stop) as system:
        print(welcome(plan), file=sys.stderr, flush=True)
        reported = False
        while not stop.wait(TURN):
            system.poll()
            if not reported and system.alive.issuperset(plan.services):
                reported = True
                log.info("all services work")
    return 0


def plan_of(arguments: argparse.Namespace) -> Plan:
    """What is to be started. Raises ConfigError."""
    listen = arguments.listen or list(Plan.listen)
    common = arguments.robot, listen, arguments.connect, arguments.config, arguments.set
    if arguments.base == SIMULATED:
        return Plan(*common, world=arguments.world or WORLD)
    if arguments.world:
        raise ConfigError(f"--world {arguments.world} is for a simulated robot; leave out --base {arguments.base}")
    return Plan(*common, base=arguments.base)


def router(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Route until Ctrl-C."""
    network = options.network(arguments)
    bus = connect(Network("router", network.connect, network.listen, network.zenoh_config), arguments.robot, stop)
    if bus:
        with bus:
            bus.announce(f"router-{arguments.name}")
            stop.wait()
    return 0


def name_part(text: str) -> str:
    """What can be a part of a key."""
    if not ROBOT_NAME.fullmatch(text) or "/" in text:
        raise argparse.ArgumentTypeError(f"{text!r} is no name: letters, digits and _ . -")
    return text


def mount(arguments: argparse.Namespace, bus: Bus, stop: StopSignal) -> int:
    """Measure the mount, around the configured one where --config or --set give it."""
    nominal = None
    if arguments.config or arguments.set:
        nominal = configuration.load("capture", CaptureConfig, arguments.config, arguments.set).mounted_floor()
    return calibrate(bus, arguments.seconds, nominal, stop)


def recording(arguments: argparse.Namespace) -> CaptureConfig:
    """The configuration with which capture would replay a recording. Raises ConfigError."""
    path, topic = arguments.recording, arguments.topic
    if not path.exists():
        raise ConfigError(f"{path}: no such file or folder")
    given = ["capture.source=replay", f"capture.path={path}", *([f"capture.topic={topic}"] if topic else [])]
    return configuration.load("capture", CaptureConfig, arguments.config, [*arguments.set, *given])


def check(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Say what is in a recording."""
    with installed("replay"):
        from cliffscan.check_data import check_data

        return check_data(arguments.recording, recording(arguments), stop)


def convert(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Make a depth folder of a recording."""
    with installed("replay"):
        from cliffscan import convert

        return convert.convert(recording(arguments), arguments.folder, arguments.every, stop)


def count(text: str) -> int:
    """A whole number from 1 on."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text}, expected 1 or more")
    return value


def seconds(text: str) -> float:
    """A time span [s] that ends."""
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} s, expected a time span")
    return value


def looked(arguments: argparse.Namespace) -> str:
    """Where on the network is looked, in words."""
    if arguments.connect:
        return f"connected to {', '.join(arguments.connect)}"
    if arguments.zenoh_config:
        return f"by {arguments.zenoh_config}"
    return "looking on this machine and its network"


def on_bus(
    work: Callable[[argparse.Namespace, Bus, StopSignal], int],
) -> Callable[[argparse.Namespace, StopSignal], int]:
    """A command that needs no more than the bus."""

    def command(arguments: argparse.Namespace, stop: StopSignal) -> int:
        bus = connect(options.network(arguments), arguments.robot, stop)
        if bus is None:
            return 0
        with bus:
            return work(arguments, bus, stop)

    return command


def add_recording(parser: argparse.ArgumentParser) -> None:
    """Add a recording and how it is read."""
    parser.add_argument(
        "recording", type=Path, metavar="PATH", help="a depth folder, a ROS 1 bag, a ROS 2 bag or an MCAP file"
    )
    parser.add_argument("--topic", default="", metavar="T", help="the depth topic, where there are several")
    options.add_config(parser)


def build_parser() -> argparse.ArgumentParser:
    """All commands and their options."""
    parser = argparse.ArgumentParser(prog="cliffscan", description="Laser scans that show where the floor ends.")
    parser.add_argument("--version", action="version", version=package_version())
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(
        name: str,
        command: Callable[[argparse.Namespace, StopSignal], int],
        text: str,
        places: Callable[[argparse.ArgumentParser], None] = options.add_network,
    ) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=text, description=text)
        places(added)
        added.set_defaults(command=command)
        return added

    started = add("up", up, "Start a router and all services on this machine; Ctrl-C ends them.", options.add_endpoints)
    started.epilog = (
        "Without options the robot is simulated. A real one: --base real --set capture.source=kinect."
        f" Worlds: {', '.join(world_names())}, {RANDOM}SEED."
    )
    options.add_config(started)
    options.add_dump_config(started)
    started.add_argument(
        "--base",
        choices=(SIMULATED, *get_args(Base)),
        default=SIMULATED,
        help="simulated with its camera; real, on kobuki.port; or none. The last two need capture.source",
    )
    started.add_argument(
        "--world", default="", metavar="NAME", help=f"where the simulated robot is, {WORLD} unless another is given"
    )
    routed = add("router", router, "Route between the processes of this machine, and to the routers --connect names.")
    routed.add_argument(
        "--name", type=name_part, default=HOST, help="it is alive as router-NAME; this machine's name by default"
    )
    add_run(commands)
    shown = add(
        "status",
        on_bus(lambda a, bus, stop: status(bus, a.watch, looked(a), stop)),
        "Show which services live, how fast and how late they are, and what is wrong.",
    )
    shown.add_argument("--watch", action="store_true", help="keep the table up to date")
    listed = add(
        "list",
        on_bus(lambda a, bus, stop: list_robots(bus, looked(a), stop) if a.all else list_keys(bus, looked(a), stop)),
        "Print a robot's live keys: tokens, and what is published, how often and as which message.",
    )
    listed.add_argument("--all", action="store_true", help="the robots on the network and their services instead")
    alive_parser = add(
        "alive", on_bus(lambda a, bus, stop: alive(a.service, bus, looked(a), stop)), "Exit 0 if a service works."
    )
    alive_parser.add_argument("service", help="as fuse, or router for any router-NAME")
    measured = add("calibrate", on_bus(mount), "Measure the camera's mount from the floor; print its configuration.")
    options.add_config(measured)
    measured.add_argument("--seconds", type=seconds, default=5.0, metavar="S", help="how long to look at the floor")
    checked = add("check-data", check, "Say what is in a recording, what is assumed, and what is wrong.", add_recording)
    checked.epilog = "Exits with 1 where a robot would suffer from something. --set gives what the recording lacks."
    converted = add("convert", convert, "Make a depth folder of a recording.", add_recording)
    converted.add_argument("folder", type=Path, metavar="DIR", help="a new or an empty folder")
    converted.add_argument("--every", type=count, default=1, metavar="N", help="each N-th image only")
    driven = add(
        "drive", on_bus(lambda a, bus, stop: drive(bus, stop, a.linear, a.angular)), "Drive with the keyboard."
    )
    driven.epilog = f"Its commands have priority {PRIORITY}: they outrank those of a program, which have 0 by default."
    driven.add_argument("--linear", type=float, default=0.2, metavar="M/S", help="speed to begin with")
    driven.add_argument("--angular", type=float, default=0.8, metavar="RAD/S", help="turn rate to begin with")
    echo_parser = add(
        "echo",
        on_bus(lambda a, bus, stop: echo(bus, a.key, a.count, a.timeout, a.full, stop)),
        "Print what is published on a key.",
    )
    echo_parser.add_argument("key", help="below the robot's name, as scan/fused; * and ** are wild")
    echo_parser.add_argument("--count", type=int, default=0, metavar="N", help="end after N messages")
    echo_parser.add_argument("--timeout", type=float, default=0.0, metavar="S", help="exit 1 if they take longer")
    echo_parser.add_argument("--full", action="store_true", help="print arrays whole")
    return parser


def main() -> None:
    """Run one command; leaves with its exit code."""
    parser = build_parser()
    arguments = parser.parse_args()
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    try:
        code = arguments.command(arguments, StopSignal())
    except ConfigRefused:
        code = USAGE_ERROR  # the service has said why
    except (BusError, ConfigError) as error:
        parser.exit(USAGE_ERROR, f"cliffscan: {error}\n")
    parser.exit(code)
