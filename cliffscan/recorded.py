"""The commands about recordings of one's own, before a robot sees them: check-data and convert."""

import argparse
from pathlib import Path

from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime import options
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.recording.commands import Add
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.open_source import installed


def add_recorded(add: Add) -> None:
    """Add check-data and convert."""
    checked = add(
        "check-data", check, "Say what is in a recording, what is assumed, and what is wrong.", _add_recording, role=""
    )
    checked.epilog = "Exits with 1 where a robot would suffer from something. --set gives what the recording lacks."
    converted = add("convert", convert, "Make a depth folder of a recording.", _add_recording, role="")
    converted.add_argument("folder", type=Path, metavar="DIR", help="a new or an empty folder")
    converted.add_argument("--every", type=count, default=1, metavar="N", help="each N-th image only")


def _add_recording(parser: argparse.ArgumentParser) -> None:
    """Add a recording and how it is read."""
    parser.add_argument(
        "recording", type=Path, metavar="PATH", help="a depth folder, a ROS 1 bag, a ROS 2 bag or an MCAP file"
    )
    parser.add_argument("--topic", default="", metavar="T", help="the depth topic, where there are several")
    options.add_config(parser)


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
