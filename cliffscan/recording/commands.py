"""The commands of recordings on the command line. What needs the extra `record` is imported when it is used."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from cliffscan.common.runtime import options
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.raw_samples import key_matcher
from cliffscan.common.runtime.service import connect
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.recording.errors import RecordingError
from cliffscan.recording.words import parse_size

Command = Callable[[argparse.Namespace, StopSignal], int]
IMAGES = 1.0  # [Hz]
RESERVE = "500M"


class Add(Protocol):
    """Adds a command to the command line."""

    def __call__(
        self, name: str, command: Command, text: str, places: options.Adder = ..., role: str = ...
    ) -> argparse.ArgumentParser:
        """Its parser."""


def add_recording(add: Add) -> None:
    """Add record, play, recover and replay-check."""
    text = "Record a robot into an MCAP file that ROS tools open too; Ctrl-C ends it."
    _add_record(add("record", record, text, role="recorder"))
    _add_play(add("play", play, "Publish a recording as it came, of a broken file too.", role=""))
    text = "Make a whole file of one whose writer was killed."
    mended = add("recover", recover, text, lambda _parser: None, role="")
    mended.add_argument("broken", type=Path, metavar="BROKEN.mcap")
    mended.add_argument("fixed", type=Path, metavar="FIXED.mcap")
    text = "Compute a recording's scans again with the services as they are now; exit 1 where they differ."
    _add_replay_check(add("replay-check", replay_check, text, options.add_config, role=""))


def _add_record(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE.mcap")
    _add_keys(parser)
    parser.add_argument("--seconds", type=options.positive, metavar="S", help="end after S seconds")
    parser.add_argument(
        "--split-size", type=_size, metavar="SIZE", help="begin FILE_1.mcap and so on after SIZE, as 2G"
    )
    parser.add_argument("--split-time", type=options.positive, metavar="S", help="begin a further file after S seconds")
    parser.add_argument(
        "--reserve", type=_size, default=_size(RESERVE), metavar="SIZE", help=f"stop before less is free, {RESERVE}"
    )
    view = parser.add_mutually_exclusive_group()
    text = f"depth images for ROS tools a second, at most: {IMAGES:g}; native frames are all there"
    view.add_argument("--images", type=_from_zero, default=IMAGES, metavar="HZ", help=text)
    view.add_argument("--no-ros", action="store_const", const=None, dest="images", help="native samples alone")


def _add_play(parser: argparse.ArgumentParser) -> None:
    parser.set_defaults(robot=None)
    parser.epilog = "Without --robot it is published under the recorded robot's name."
    parser.add_argument("file", type=Path, metavar="FILE.mcap")
    _add_keys(parser)
    parser.add_argument("--rate", type=options.positive, default=1.0, metavar="R", help="R times as fast")
    parser.add_argument(
        "--start", type=_from_zero, default=0.0, metavar="S", help="begin S seconds after the beginning"
    )
    parser.add_argument("--loop", action="store_true", help="begin again at the end")
    parser.add_argument(
        "--commands", action="store_true", help="play commands to a base too, and beside a base that lives"
    )


def _add_replay_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE.mcap")
    parser.add_argument(
        "--tolerance", type=_from_zero, default=0.01, metavar="M", help="by which a beam may move [m], 0.01"
    )
    parser.add_argument(
        "--share", type=_from_zero, default=0.001, metavar="S", help="of a scan's beams may differ, 0.001"
    )
    parser.add_argument("--picture", type=Path, metavar="FILE.png", help="draw the frame that differs most")
    parser.add_argument("--renew", type=Path, metavar="NEW.mcap", help="write the recording with today's scans")


def _add_keys(parser: argparse.ArgumentParser) -> None:
    text = "below the robot's name, as scan/fused; * and ** are wild; all by default"
    parser.add_argument("--keys", nargs="+", type=_key, default=["**"], metavar="KEY", help=text)


def record(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Answer `cliffscan record`."""
    with _one_line(arguments.file):
        from cliffscan.recording import parts
        from cliffscan.recording import record as recording

        limits = parts.Limits(arguments.split_size, arguments.split_time)
        chosen = recording.Options(
            arguments.file, arguments.keys, limits, arguments.images, arguments.reserve, arguments.seconds
        )
        recording.check(chosen)
        bus = connect(options.network(arguments), arguments.robot, stop)
        if bus is None:
            return 0
        with bus:
            return recording.record(bus, chosen, stop)


def play(arguments: argparse.Namespace, stop: StopSignal) -> int:
    """Answer `cliffscan play`."""
    with _one_line(arguments.file):
        from cliffscan.recording import play as playing
        from cliffscan.recording.reading import Recording

        if arguments.secure:
            raise ConfigError("no role may publish what a recording holds: play it on a network without --secure")
        recording = Recording(arguments.file)
        chosen = playing.Options(arguments.keys, arguments.rate, arguments.start, arguments.loop, arguments.commands)
        bus = connect(options.network(arguments), arguments.robot or recording.robot, stop)
        if bus is None:
            return 0
        with bus:
            return playing.play(bus, recording, chosen, stop)


def recover(arguments: argparse.Namespace, _stop: StopSignal) -> int:
    """Answer `cliffscan recover`."""
    with _one_line(arguments.fixed):
        from cliffscan.recording import recover as mending

        return mending.recover(arguments.broken, arguments.fixed)


def replay_check(arguments: argparse.Namespace, _stop: StopSignal) -> int:
    """Answer `cliffscan replay-check`."""
    with _one_line(arguments.file):
        from cliffscan.recording import replay_check as checking

        limits = checking.Limits(arguments.tolerance, arguments.share)
        configs = (arguments.config, arguments.set)
        return checking.replay_check(arguments.file, configs, limits, arguments.picture, arguments.renew)


@contextmanager
def _one_line(file: Path) -> Iterator[None]:
    """Turn what may be wrong with a file or an option into ConfigError, one line with its remedy."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise ConfigError(f"recordings need the package {error.name}: pip install 'cliffscan[record]'") from error
    except FileExistsError as error:
        raise ConfigError(f"{error.filename or file} is there already: choose another name, or remove it") from error
    except OSError as error:
        raise ConfigError(f"{error.filename or file}: {error.strerror}") from error
    except RecordingError as error:
        raise ConfigError(str(error)) from error


def _key(text: str) -> str:
    """A key below the robot's name."""
    try:
        key_matcher([text])
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return text


def _size(text: str) -> int:
    try:
        return parse_size(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _from_zero(text: str) -> float:
    """A number that is not below 0 and not endless."""
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}, expected 0 or more")
    return value
