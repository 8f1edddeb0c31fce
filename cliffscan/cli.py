"""The command line of `cliffscan`."""

import argparse
import logging
import math
import re
import socket
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import get_args

from cliffscan.calibrate import calibrate
from cliffscan.calibrate_base import measure_base
from cliffscan.closed_pipe import quiet_where_nobody_reads
from cliffscan.common.contract.roles import ROUTER, WORKSTATION_ROUTER
from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime import options
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.network import BusError
from cliffscan.common.runtime.secure import ROUTERS, SecureError
from cliffscan.common.runtime.service import USAGE_ERROR, connect, package_version
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.doctor.command import doctor
from cliffscan.drive import PRIORITY, drive
from cliffscan.echo import echo
from cliffscan.listing import list_keys, list_robots
from cliffscan.live import alive
from cliffscan.parts import NO_BASE, REAL, WORKSTATION, Part, bases, listening
from cliffscan.recorded import add_recorded
from cliffscan.recording.commands import add_recording
from cliffscan.router import route
from cliffscan.run import add_run
from cliffscan.secure.command import add_keys
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.simulator.world_names import RANDOM, world_names
from cliffscan.status import status
from cliffscan.supervisor import ConfigRefused
from cliffscan.system import TURN, Plan, System
from cliffscan.systemd import print_units
from cliffscan.welcome import welcome

SIMULATED = "simulated"
ALIVE = 5.0  # [s] in which a router must answer, for `alive`
VIEW_PORT, VIEW_BIND = 8080, "127.0.0.1"
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
    part, base = arguments.part, arguments.base or (NO_BASE if arguments.part == WORKSTATION else arguments.usual_base)
    if part == WORKSTATION and (arguments.base or arguments.world):
        given = f"--base {arguments.base}" if arguments.base else f"--world {arguments.world}"
        raise ConfigError(f"{given}: camera and base are of --part robot: leave it out")
    if arguments.world and base != SIMULATED:
        raise ConfigError(f"--world {arguments.world} is for a simulated robot; leave out --base {base}")
    return Plan(
        arguments.robot,
        arguments.listen or [listening(part, bool(arguments.secure))],
        arguments.connect,
        arguments.config,
        arguments.set,
        base=NO_BASE if base == SIMULATED else base,
        world=(arguments.world or WORLD) if base == SIMULATED else "",
        secure=arguments.secure,
        insecure=arguments.insecure,
        part=part,
        perception=arguments.perception,
    )


def systemd(arguments: argparse.Namespace) -> int:
    """Print units. Raises ConfigError for what up would refuse."""
    for name in ("config", "secure"):
        if given := getattr(arguments, name):
            setattr(arguments, name, given.resolve())
    plan = plan_of(arguments)
    if plan.world:
        raise ConfigError("--base simulated: units are for a robot: choose another base, and `cliffscan up` to try it")
    plan.check()
    return print_units(plan, arguments.user, arguments.out)


def router(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Route until Ctrl-C."""
    if not arguments.role:
        joins = arguments.connect or arguments.name == "workstation"
        arguments.role = WORKSTATION_ROUTER if joins else ROUTER
    return route(replace(options.network(arguments), mode="router"), arguments.robot, arguments.name, stop)


def view(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Serve the live page until Ctrl-C. Raises ConfigError where its packages are not installed."""
    try:
        from cliffscan.view.command import view as serve
    except ModuleNotFoundError as error:
        raise ConfigError(f"view: {error.name} is not installed: pip install 'cliffscan[view]'") from error
    network, where = options.network(arguments), looked(arguments)
    page = arguments.bind, arguments.port, arguments.allow_origin
    return serve(network, arguments.robot, where, *page, stop)


def name_part(text: str) -> str:
    """What can be a part of a key."""
    if not ROBOT_NAME.fullmatch(text) or "/" in text:
        raise argparse.ArgumentTypeError(f"{text!r} is no name: letters, digits and _ . -")
    return text


def measured(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Measure the mount with an operator's keys, or the base, which is driven, with a driver's."""
    arguments.role = arguments.role or ("driver" if arguments.base else "operator")
    return on_bus(measure)(arguments, stop)


def measure(arguments: argparse.Namespace, bus: Bus, stop: StopSignal) -> int:
    """Measure the base, or the mount, around the configured one where --config or --set give it."""
    if arguments.base:
        return measure_base(bus, arguments.free, arguments.speed, math.radians(arguments.turn), stop)
    nominal = None
    if arguments.config or arguments.set:
        nominal = configuration.load("capture", CaptureConfig, arguments.config, arguments.set).mounted_floor()
    return calibrate(bus, arguments.seconds, nominal, stop)


def port(text: str) -> int:
    """A port of this machine; 0 is any that is free."""
    number = int(text) if text.isdecimal() else -1
    if not 0 <= number < 2**16:
        raise argparse.ArgumentTypeError(f"{text!r} is no port: expected 0 to 65535")
    return number


def between(least: float, most: float, what: str) -> Callable[[str], float]:
    """A number of an option, in its bounds."""

    def number(text: str) -> float:
        value = float(text)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text}, expected {what} between {least:g} and {most:g}")
        return value

    return number


free_floor = between(0.5, 5.0, "metres of free floor")
speed_limit = between(0.1, 2.0, "a speed [m/s]")
turn_limit = between(10.0, 180.0, "a turn rate [deg/s]")


def looked(arguments: argparse.Namespace) -> str:
    """Where on the network is looked, in words."""
    if arguments.connect:
        return f"at {', '.join(arguments.connect)}"
    if arguments.secure or arguments.zenoh_config:
        return f"at the endpoints of {arguments.secure or arguments.zenoh_config}"
    return "on this machine and its network"


def on_bus(
    work: Callable[[argparse.Namespace, Bus, StopSignal], int],
) -> Callable[[argparse.Namespace, StopSignal], int]:
    """A command that needs no more than the bus."""

    def command(arguments: argparse.Namespace, stop: StopSignal) -> int:
        bus = connect(options.network(arguments), arguments.robot, stop, arguments.timeout or math.inf)
        if bus is None and stop.is_set():
            return 0
        if bus is None:
            print(f"cliffscan: no router within {arguments.timeout:g} s", file=sys.stderr)
            return 1
        with bus:
            if notice := bus.notice():
                print(f"cliffscan: {arguments.role}: {notice}", file=sys.stderr)
            return work(arguments, bus, stop)

    return command


def add_plan(parser: argparse.ArgumentParser, base: str = SIMULATED) -> None:
    """Add what says which services are started, for plan_of(). base: where none is named."""
    parser.set_defaults(usual_base=base)
    parser.add_argument(
        "--part",
        choices=get_args(Part),
        help="one of two hosts: the robot's camera and base, or the workstation's services. All are here by default",
    )
    parser.add_argument(
        "--perception",
        action="store_true",
        help="one process for all scans; with --part robot it is on the robot, for a thin link",
    )
    parser.add_argument(
        "--base",
        choices=(SIMULATED, *bases()),
        metavar="BASE",
        help=f"{SIMULATED} with its camera; real, a Kobuki on kobuki.port; gate, for any other; or none ({base}). All"
        f" but {SIMULATED} need capture.source",
    )
    parser.add_argument(
        "--world", default="", metavar="NAME", help=f"where the simulated robot is, {WORLD} unless another is given"
    )


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
        role: str = options.VIEWER,  # empty: its own affair
    ) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=text, description=text)
        places(added)
        if role:
            added.add_argument("--role", default=role, metavar="NAME", help=f"whose keys --secure uses ({role})")
        added.set_defaults(command=command, timeout=0.0)  # no limit, where there is no option for it
        return added

    started = add(
        "up",
        up,
        "Start a router and all services on this machine; Ctrl-C ends them.",
        options.add_endpoints,
        role="",
    )
    started.epilog = (
        "Without options the robot is simulated. A real one: --base real --set capture.source=kinect."
        f" Worlds: {', '.join(world_names())}, {RANDOM}SEED."
    )
    options.add_config(started)
    options.add_dump_config(started)
    add_plan(started)
    made = add(
        "systemd",
        lambda a, _: systemd(a),
        "Print the systemd units that start this machine's services when it starts.",
        options.add_endpoints,
        role="",
    )
    options.add_config(made)
    add_plan(made, base=REAL)
    made.add_argument("--user", default="cliffscan", metavar="NAME", help="as whom they run (cliffscan)")
    made.add_argument("--out", type=Path, metavar="DIR", help="write the units there instead of printing them")
    routed = add(
        "router",
        router,
        "Route between the processes of this machine, and to the routers --connect names.",
        role="",
    )
    routed.add_argument(
        "--role",
        choices=ROUTERS,
        default="",
        help=f"whose keys it uses; {WORKSTATION_ROUTER} where it joins another or is named workstation",
    )
    routed.add_argument(
        "--name", type=name_part, default=HOST, help="it is alive as router-NAME; this machine's name by default"
    )
    add_run(commands)
    add_keys(commands)
    shown = add(
        "status",
        on_bus(lambda a, bus, stop: status(bus, a.watch, looked(a), stop)),
        "Show which services live, how fast and how late they are, and what is wrong.",
    )
    shown.add_argument("--watch", action="store_true", help="keep the table up to date")
    examined = add(
        "doctor",
        doctor,
        "Look at this machine and at what arrives of a robot: a line for each finding, with its remedy; exit 1 for a"
        " fault.",
        role="recorder",
    )
    options.add_config(examined)
    examined.add_argument("--part", choices=get_args(Part), help="what this host is; both by default")
    examined.add_argument("--seconds", type=options.positive, default=4.0, metavar="S", help="how long to look")
    listed = add(
        "list",
        on_bus(lambda a, bus, stop: list_robots(bus, looked(a), stop) if a.all else list_keys(bus, looked(a), stop)),
        "Print a robot's live keys: tokens, and what is published, how often and as which message.",
    )
    listed.add_argument("--all", action="store_true", help="the robots on the network and their services instead")
    alive_parser = add(
        "alive", on_bus(lambda a, bus, stop: alive(a.service, bus, looked(a), stop)), "Exit 0 if a service works."
    )
    alive_parser.set_defaults(timeout=ALIVE)
    alive_parser.add_argument("service", help="as fuse, or router for any router-NAME")
    calibrating = add(
        "calibrate",
        measured,
        "Measure the camera's mount from the floor, or the base; print the configuration.",
        role="",
    )
    options.add_config(calibrating)
    calibrating.add_argument(
        "--role", default="", metavar="NAME", help="whose keys --secure uses (operator; driver with --base)"
    )
    calibrating.add_argument(
        "--seconds", type=options.positive, default=5.0, metavar="S", help="how long to look at the floor"
    )
    calibrating.add_argument("--base", action="store_true", help="drive the robot, and measure how it brakes instead")
    free, speed, turn = "free floor ahead (1.5)", "highest speed (0.5)", "highest turn rate (60)"
    calibrating.add_argument("--free", type=free_floor, default=1.5, metavar="M", help=f"with --base: {free}")
    calibrating.add_argument("--speed", type=speed_limit, default=0.5, metavar="M/S", help=f"with --base: {speed}")
    calibrating.add_argument("--turn", type=turn_limit, default=60.0, metavar="DEG/S", help=f"with --base: {turn}")
    add_recorded(add)
    driven = add(
        "drive",
        on_bus(lambda a, bus, stop: drive(bus, stop, a.linear, a.angular)),
        "Drive with the keyboard.",
        role="driver",
    )
    driven.epilog = f"Its commands have priority {PRIORITY}: they outrank those of a program, which have 0 by default."
    driven.add_argument("--linear", type=float, default=0.2, metavar="M/S", help="speed to begin with")
    driven.add_argument("--angular", type=float, default=0.8, metavar="RAD/S", help="turn rate to begin with")
    viewed = add("view", view, "Serve a live page that shows why the robot stopped; Ctrl-C ends it.", role="operator")
    viewed.epilog = "The same port speaks Foxglove's protocol. Without --robot the page lets you choose."
    viewed.add_argument("--port", type=port, default=VIEW_PORT, help="of the page (default %(default)s)")
    viewed.add_argument(
        "--bind",
        default=VIEW_BIND,
        metavar="ADDRESS",
        help="address to serve on (default %(default)s); beyond this machine the page's address has a token",
    )
    viewed.add_argument(
        "--allow-origin", action="append", default=[], metavar="ORIGIN", help="a web page of others that may connect"
    )
    add_recording(add)
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
    with quiet_where_nobody_reads():
        parser = build_parser()
        arguments = parser.parse_args()
        logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
        try:
            code = arguments.command(arguments, StopSignal())
        except ConfigRefused:
            code = USAGE_ERROR  # the service has said why
        except (BusError, ConfigError, SecureError) as error:
            parser.exit(USAGE_ERROR, f"cliffscan: {error}\n")
        parser.exit(code)
