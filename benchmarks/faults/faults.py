"""What can go wrong, by name: how it begins, how it ends.

A camera that repeats its last image with new stamps cannot be told from one that stands before something still, so it
is no fault of this list. A base whose line is cut obeys its last command, for nobody can tell it to stop, and the
emulated firmware has no timeout of its own, as the real one may not have either.
"""

from __future__ import annotations

import signal
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from benchmarks.faults.frame_relay import Mode
from benchmarks.faults.rig import Rig
from common.config import SERVICES

PROCESSES = ("router", *SERVICES)
LATE = 0.6  # [s] of a late frame
CUT = 1.5  # [s] of the serial line

Deed = Callable[[Rig], None]


class Fault(NamedTuple):
    """How a fault begins, and how it is taken back after a while; a process that was killed is started anew anyway."""

    begin: Deed
    end: Deed


def nothing(rig: Rig) -> None:
    """What has to be done where something else does it."""


def tell(name: str, number: signal.Signals, rig: Rig) -> None:
    """Send a signal to a process."""
    rig.send(name, number)


def start(name: str, rig: Rig) -> None:
    """Start a process."""
    rig.start(name)


def frames(mode: Mode, rig: Rig) -> None:
    """Have the frames come so from now on."""
    rig.relay.mode, rig.relay.delay = mode, LATE


def line(command: str, rig: Rig) -> None:
    """Have something done to the serial line."""
    rig.remote.tell(command)


def quiet(silent: bool, rig: Rig) -> None:
    """Have the driver say nothing, or go on."""
    rig.quiet = silent


def known_faults() -> dict[str, Fault]:
    """All faults by name."""
    found: dict[str, Fault] = {}
    for name in PROCESSES:
        found[f"{name} killed"] = Fault(partial(tell, name, signal.SIGKILL), nothing)
        frozen, on = partial(tell, name, signal.SIGSTOP), partial(tell, name, signal.SIGCONT)
        found[f"{name} stopped"] = Fault(frozen, on)
        found[f"{name} restarted"] = Fault(partial(tell, name, signal.SIGTERM), partial(start, name))
    passing = partial(frames, "pass")
    return found | {
        "frames late": Fault(partial(frames, "late"), passing),
        "frames frozen": Fault(partial(frames, "frozen"), passing),
        "frames dropped": Fault(partial(frames, "dropped"), passing),
        "line cut": Fault(partial(line, f"unplug {CUT}"), nothing),
        "line mute": Fault(partial(line, f"pause {CUT}"), nothing),
        "driver silent": Fault(partial(quiet, True), partial(quiet, False)),
    }
