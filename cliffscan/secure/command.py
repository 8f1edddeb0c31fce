"""`cliffscan keys`: make, renew and check the keys with which a robot's processes are let in."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from datetime import timedelta
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from cliffscan.common.contract.ros_keys import DOMAIN, LAST_DOMAIN
from cliffscan.common.runtime import options
from cliffscan.common.runtime.secure import SecureError

if TYPE_CHECKING:
    from cliffscan.secure.folder import KeyFolder

    Commands = argparse._SubParsersAction[argparse.ArgumentParser]

DAYS = 365


def add_keys(commands: Commands) -> None:
    """Add the command to a parser's commands."""
    text = "Make, renew and check the keys of a robot, for --secure DIR."
    parser = commands.add_parser("keys", help=text, description=text)
    works = parser.add_subparsers(required=True, metavar="WORK")

    def add(name: str, work: Callable[[argparse.Namespace, KeyFolder], int], words: str) -> argparse.ArgumentParser:
        added = works.add_parser(name, help=words, description=words)
        added.add_argument("directory", type=Path, metavar="DIR")
        added.set_defaults(command=lambda arguments, _stop: work(arguments, _folder(arguments)))
        return added

    made = add("init", init, "Make a CA, and for each role a folder with its keys and its Zenoh file.")
    options.add_robot(made)
    text = "name or address of the robot's host, and of others with a router; repeatable, the robot's first"
    made.add_argument("--host", action="append", default=[], metavar="NAME", help=text)
    text = f"ROS_DOMAIN_ID of its ROS 2 nodes, {DOMAIN} by default"
    made.add_argument("--ros-domain", type=int, choices=range(LAST_DOMAIN + 1), default=DOMAIN, metavar="N", help=text)
    issued = add("issue", issue, "Make the keys of one role anew, or those of a further sensor.")
    issued.add_argument("role", help="as negative, or sensor-NAME for what publishes scan/NAME")
    for each in (made, issued, add("renew", renew, "Make new certificates for all keys, before the old ones expire.")):
        each.add_argument(
            "--days", type=_days, default=DAYS, metavar="N", help=f"how long they hold, {DAYS} by default"
        )
    add("check", check, "Look for keys that are wrong or end soon; exit 1 where there are some.")


def init(arguments: argparse.Namespace, folder: KeyFolder) -> int:
    """Make everything."""
    folder.init(arguments.robot, arguments.host, timedelta(days=arguments.days), arguments.ros_domain)
    print(f"{folder.directory}: keys of robot {arguments.robot} for {', '.join(folder.roles())}")
    print("Copy to each host the folders of the roles that run there, and give its processes --secure.")
    print(f"{folder.directory}/ca/key.pem makes keys for any role. Keep it off the robot, where nobody else reads it.")
    return 0


def issue(arguments: argparse.Namespace, folder: KeyFolder) -> int:
    """Make one role's keys."""
    new_rules = folder.issue(arguments.role, timedelta(days=arguments.days))
    print(f"{folder.directory / arguments.role}: made; copy it to where {arguments.role} runs")
    if new_rules:
        print("The routers have a new rule: copy their zenoh.json5, too.")
    return 0


def renew(arguments: argparse.Namespace, folder: KeyFolder) -> int:
    """Make all certificates anew."""
    rewritten = folder.renew(timedelta(days=arguments.days))
    print(f"{folder.directory}: new certificates; copy each cert.pem to where its role runs; nothing need be restarted")
    if rewritten:
        print(f"Written anew, to be copied too: zenoh.json5 of {', '.join(rewritten)}")
    return 0


def check(_arguments: argparse.Namespace, folder: KeyFolder) -> int:
    """Say how each role's keys are; 1 where some are wrong or end soon."""
    found = list(folder.check())
    for role, line, good in found:
        print(f"{role:18}  {'ok   ' if good else 'WRONG'}  {line}")
    return 0 if all(good for _, _, good in found) else 1


def _folder(arguments: argparse.Namespace) -> KeyFolder:
    """The folder, where this machine can make keys. Raises SecureError."""
    try:
        made: KeyFolder = import_module("cliffscan.secure.folder").KeyFolder(arguments.directory)
    except ImportError as error:
        raise SecureError(f"keys: {error}: install cliffscan[secure]") from error
    return made


def _days(text: str) -> int:
    value = int(text) if text.isdecimal() else 0
    if not 0 < value <= 3650:
        raise argparse.ArgumentTypeError(f"{text} days, expected 1 to 3650")
    return value
