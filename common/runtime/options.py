"""The command line that every process on the network shares."""

import argparse
import math
from collections.abc import Callable
from pathlib import Path

from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.common.runtime.network import Network
from cliffscan.common.runtime.secure import Credentials

ROBOT = "turtlebot"
EVERY = "*"  # on the command line
VIEWER = "viewer"  # the role of who only looks


def robot_name(text: str) -> str:
    """A name that can begin a key."""
    if not ROBOT_NAME.fullmatch(text):
        raise argparse.ArgumentTypeError(
            f"{text!r} is no robot name: letters, digits and _ . - in parts with / between"
        )
    return text


def positive(text: str) -> float:
    """A number above 0 that is not endless, as a time span [s]."""
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}, expected a number above 0")
    return value


def robot_or_every(text: str) -> str:
    """A name that can begin a key, or EVERY."""
    return text if text == EVERY else robot_name(text)


def add_robot(parser: argparse.ArgumentParser) -> None:
    """Add --robot."""
    parser.add_argument("--robot", default=ROBOT, type=robot_name, metavar="NAME", help="prefix of its keys")


def add_robots(parser: argparse.ArgumentParser) -> None:
    """Add a --robot that may be given several times; none is [ROBOT] to robots()."""
    text = f"prefix of its keys; repeatable; '{EVERY}' is every robot that publishes"
    parser.add_argument("--robot", action="append", default=[], type=robot_or_every, metavar="NAME", help=text)


def robots(options: argparse.Namespace) -> list[str] | None:
    """The robots of add_robots(), each once; None where every one is meant."""
    return None if EVERY in options.robot else list(dict.fromkeys(options.robot)) or [ROBOT]


Adder = Callable[[argparse.ArgumentParser], None]


def add_endpoints(parser: argparse.ArgumentParser, robot: Adder = add_robot) -> None:
    """Add --robot, --connect, --listen, and whose keys are used: those of `role`, a default that callers set."""
    robot(parser)
    parser.set_defaults(role=VIEWER)
    parser.add_argument("--connect", action="append", default=[], metavar="ENDPOINT", help="as tcp/127.0.0.1:7447")
    parser.add_argument("--listen", action="append", default=[], metavar="ENDPOINT", help="as tls/0.0.0.0:7447")
    parser.add_argument(
        "--secure", type=Path, metavar="DIR", help="the folder of `cliffscan keys`: use the role's keys"
    )
    parser.add_argument("--insecure", action="store_true", help="let other machines connect without keys")


def add_network(parser: argparse.ArgumentParser, robot: Adder = add_robot) -> None:
    """Add the endpoints and the rest of Zenoh's options."""
    add_endpoints(parser, robot)
    parser.add_argument("--mode", choices=("peer", "client", "router"), help="Zenoh mode")
    parser.add_argument("--zenoh-config", type=Path, metavar="FILE", help="a Zenoh JSON5 file; options override it")


def add_config(parser: argparse.ArgumentParser) -> None:
    """Add --config and --set."""
    parser.add_argument("--config", type=Path, metavar="FILE", help="TOML, one table per service")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override one value")


def add_dump_config(parser: argparse.ArgumentParser) -> None:
    """Add --dump-config."""
    parser.add_argument("--dump-config", action="store_true", help="print the effective configuration and exit")


def network(options: argparse.Namespace) -> Network:
    """The network that the options describe."""
    named = options.robot if isinstance(options.robot, list) else [options.robot]
    secure = Credentials(options.secure, options.role, named or [ROBOT]) if options.secure else None
    return Network(options.mode, options.connect, options.listen, options.zenoh_config, secure, options.insecure)
