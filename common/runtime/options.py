"""The command line that every process on the network shares."""

import argparse
from pathlib import Path

from cliffscan.common.contract.topics import ROBOT_NAME
from cliffscan.common.runtime.bus import Network


def robot_name(text: str) -> str:
    """A name that can begin a key."""
    if not ROBOT_NAME.fullmatch(text):
        raise argparse.ArgumentTypeError(
            f"{text!r} is no robot name: letters, digits and _ . - in parts with / between"
        )
    return text


def add_endpoints(parser: argparse.ArgumentParser) -> None:
    """Add --robot, --connect and --listen."""
    parser.add_argument("--robot", default="turtlebot", type=robot_name, metavar="NAME", help="prefix of its keys")
    parser.add_argument("--connect", action="append", default=[], metavar="ENDPOINT", help="as tcp/127.0.0.1:7447")
    parser.add_argument("--listen", action="append", default=[], metavar="ENDPOINT", help="as tcp/0.0.0.0:7447")


def add_network(parser: argparse.ArgumentParser) -> None:
    """Add the endpoints and the rest of Zenoh's options."""
    add_endpoints(parser)
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
    return Network(options.mode, options.connect, options.listen, options.zenoh_config)
