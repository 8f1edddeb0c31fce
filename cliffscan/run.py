"""`cliffscan run SERVICE`: this process becomes the service. It imports little, for a service shall not wait for it."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from cliffscan import services

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[argparse.ArgumentParser]


def command_line(service: str, options: Sequence[str]) -> list[str]:
    """How a service is started wherever the package is installed."""
    return [sys.executable, "-m", f"cliffscan.services.{service}", *options]


def service_names() -> list[str]:
    """All services that can be run."""
    return sorted(main.parent.name for folder in services.__path__ for main in Path(folder).glob("*/__main__.py"))


def add_run(commands: Commands) -> None:
    """Add the command to a parser's commands."""
    text = "Run one service; `cliffscan run SERVICE --help` prints its options."
    parser = commands.add_parser("run", help=text, description=text)
    names = service_names()
    parser.add_argument("service", choices=names, metavar="SERVICE", help=", ".join(names))
    parser.add_argument("options", nargs=argparse.REMAINDER, metavar="...", help="the service's own options")


def main() -> None:
    """Answer `cliffscan run`."""
    parser = argparse.ArgumentParser(prog="cliffscan")
    add_run(parser.add_subparsers())
    arguments = parser.parse_args()
    os.execv(sys.executable, command_line(arguments.service, arguments.options))
