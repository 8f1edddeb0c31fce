"""The command line of `cliffscan`."""

from __future__ import annotations

import argparse
import logging
import math
import time
from collections.abc import Callable
from typing import get_args

from cliffscan.calibrate import calibrate
from cliffscan.drive import drive
from cliffscan.echo import echo
from cliffscan.status import status
from cliffscan.supervisor import ConfigRefused
from cliffscan.system import TURN, Base, Plan, System
from common import config as configuration
from common import options
from common.bus import Bus, BusError, Network
from common.config import ConfigError
from common.service import USAGE_ERROR, StopSignal, connect, package_version
from services.capture.config import CaptureConfig

PATIENCE = 1.0  # [s] in which a new session has heard of every service that works

log = logging.getLogger("cliffscan")


def up(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Run everything until Ctrl-C."""
    listen = arguments.listen or list(Plan.listen)
    plan = Plan(
        arguments.robot, listen, arguments.connect, arguments.config, arguments.set, arguments.base, arguments.world
    )
    with System(plan, stop) as system:
        while not stop.wait(TURN):
            system.poll()
    return 0


def router(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Route until Ctrl-C."""
    network = options.network(arguments)
    bus = connect(Network("router", network.connect, network.listen, network.zenoh_config), arguments.robot, stop)
    if bus:
        with bus:
            bus.announce("router")
            stop.wait()
    return 0


def alive(service: str, bus: Bus, stop: StopSignal) -> int:
    """0 as soon as `service` is heard to work; 1 where that takes longer than news of it can take."""
    deadline = time.monotonic() + PATIENCE
    while service not in bus.alive():
        if time.monotonic() > deadline or stop.wait(TURN):
            return 1
    return 0


def mount(arguments: argparse.Namespace, bus: Bus, stop: StopSignal) -> int:
    """Measure the mount, around the configured one where --config or --set tell it."""
    nominal = None
    if arguments.config or arguments.set:
        nominal = configuration.load("capture", CaptureConfig, arguments.config, arguments.set).mounted_floor()
    return calibrate(bus, arguments.seconds, nominal, stop)


def seconds(text: str) -> float:
    """A time span [s] that ends."""
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} s, expected a time span")
    return value


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
    options.add_config(started)
    started.add_argument(
        "--base", choices=get_args(Base), default="emulated", help="the robot's base: emulated, on kobuki.port, or none"
    )
    started.add_argument(
        "--world", default="", metavar="NAME", help="simulate the robot, base and camera, in a world; or random:SEED"
    )
    add("router", router, "Route between the processes of this machine, and to the routers that --connect names.")
    shown = add(
        "status",
        on_bus(lambda a, bus, stop: status(bus, a.watch, stop)),
        "Show which services live, how fast and how late they are.",
    )
    shown.add_argument("--watch", action="store_true", help="keep the table up to date")
    told = add("alive", on_bus(lambda a, bus, stop: alive(a.service, bus, stop)), "Exit 0 if a service works.")
    told.add_argument("service")
    measured = add("calibrate", on_bus(mount), "Measure the camera's mount from the floor; print its configuration.")
    options.add_config(measured)
    measured.add_argument("--seconds", type=seconds, default=5.0, metavar="S", help="how long to look at the floor")
    driven = add(
        "drive", on_bus(lambda a, bus, stop: drive(bus, stop, a.linear, a.angular)), "Drive with the keyboard."
    )
    driven.add_argument("--linear", type=float, default=0.2, metavar="M/S", help="speed to begin with")
    driven.add_argument("--angular", type=float, default=0.8, metavar="RAD/S", help="turn rate to begin with")
    heard = add(
        "echo",
        on_bus(lambda a, bus, stop: echo(bus, a.key, a.count, a.timeout, a.full, stop)),
        "Print what is said on a key.",
    )
    heard.add_argument("key", help="below the robot's name, as scan/fused; * and ** are wild")
    heard.add_argument("--count", type=int, default=0, metavar="N", help="end after N messages")
    heard.add_argument("--timeout", type=float, default=0.0, metavar="S", help="exit 1 if they take longer")
    heard.add_argument("--full", action="store_true", help="print arrays whole")
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
