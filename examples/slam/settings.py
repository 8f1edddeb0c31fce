"""What a plug-in is given on its command line."""

import argparse
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from examples.slam.pose import Pose


@dataclass(frozen=True)
class Settings:
    """The command line, read and checked."""

    robot: str
    connect: list[str]
    listen: list[str]
    mode: str | None
    scan: str  # path of the scan below the robot's name
    name: str | None  # of this map, where several are made at once
    origin: Pose | None  # of the scan on the robot, where it is not the described camera's
    reach: float  # [m]
    near: float | None  # [m]
    resolution: float  # [m]
    out: Path | None
    every: float | None  # [s]
    zenoh_config: Path | None = None

    def path(self, path: str) -> str:
        """A path of this plug-in's own, with the map's name at its end if it has one."""
        return f"{path}/{self.name}" if self.name else path

    @property
    def token(self) -> str:
        """The name under which this plug-in is alive."""
        return f"slam-{self.name}" if self.name else "slam"


def read(program: str, text: str | None, words: Sequence[str] | None = None) -> Settings:
    """The settings in the command line, or in these words. A bad one ends the process with one line and exit 2."""
    fields = vars(_parser(program, text).parse_args(words))
    if origin := fields.pop("origin"):
        x, y, yaw = origin
        origin = Pose(x, y, math.radians(yaw))
    return Settings(origin=origin, **fields)


def _parser(program: str, text: str | None) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=program, description=text)
    add = parser.add_argument
    add("--robot", default="turtlebot", type=_robot, metavar="NAME", help="prefix of its keys (%(default)s)")
    add("--connect", action="append", default=[], metavar="ENDPOINT", help="as tcp/127.0.0.1:7447; repeatable")
    add("--listen", action="append", default=[], metavar="ENDPOINT", help="as tcp/0.0.0.0:7448; repeatable")
    add("--mode", choices=("peer", "client", "router"), help="Zenoh mode (peer)")
    add("--zenoh-config", type=Path, metavar="FILE", help="as keys/slam/zenoh.json5; the options above override it")
    add("--scan", default="scan/fused", metavar="PATH", help="the scan to map (%(default)s)")
    add("--name", type=_name, help="publish map/NAME and pose/NAME, beside other plug-ins of one robot")
    place = ("X", "Y", "DEGREES")
    add("--origin", nargs=3, type=_number, metavar=place, help="of the scan on the robot (the described camera's)")
    add("--reach", default=4.0, type=_length, metavar="M", help="farthest that a scan is believed (%(default)s)")
    add("--near", type=_distance, metavar="M", help="nearer no floor is seen (as the camera is described)")
    add("--resolution", default=0.05, type=_length, metavar="M", help="side of a cell (%(default)s)")
    add("--out", type=Path, metavar="DIR", help="save map.pgm and map.yaml there at the end")
    add("--every", type=_length, metavar="SECONDS", help="and in between")
    return parser


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text}, expected a number")
    return value


def _distance(text: str) -> float:
    value = _number(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text}, expected 0 or more")
    return value


def _length(text: str) -> float:
    value = _number(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"{text}, expected more than 0")
    return value


def _robot(text: str) -> str:
    if not re.fullmatch(r"[\w.-]+(/[\w.-]+)*", text, re.ASCII):
        raise argparse.ArgumentTypeError(f"{text!r} can begin no key")
    return text


def _name(text: str) -> str:
    if not text.isidentifier():
        raise argparse.ArgumentTypeError(f"{text!r}, expected letters and digits")
    return text
