"""What can go wrong, by name: how it begins, how it ends.

A base whose line is cut obeys its last command, for nobody can tell it to stop, and the
emulated firmware has no timeout of its own, as the real one may not have either.
"""

from __future__ import annotations

import signal
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from benchmarks.faults.frame_relay import Mode
from benchmarks.faults.rig import Rig
from cliffscan.common.runtime.config import SERVICES

PROCESSES = ("router", *SERVICES)
LATE = 0.6  # [s] of a late frame
CUT = 1.5  # [s] of the serial line
CREEPING = (4.0, 8.0)  # [s] of a fault that shows on the way only
FLOODED = 0.3  # [s] of a flood before the stop
SLOW = 1200  # [bytes/s] of a slow one, a tenth of the real one

Deed = Callable[[Rig], None]


def nothing(rig: Rig) -> None:
    """What has to be done where something else does it."""


class Fault(NamedTuple):
    """How a fault begins, and how it is taken back after a while; a process that was killed is started anew anyway."""

    begin: Deed
    end: Deed
    prepare: Deed = nothing  # before the robot drives: what takes a while to start
    lasts: tuple[float, float] = (1.2, 2.5)  # [s] from its beginning to its end


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


def encoders(share: float, rig: Rig) -> None:
    """Have the encoders count a share of the way; what the gate then no longer believes, an operator clears."""
    rig.remote.tell(f"encoders {share} {share}")
    if share == 1.0:
        rig.ask("clear_safety")


def late(on: bool, rig: Rig) -> None:
    """Hold the driver's commands back, and let them arrive in bursts."""
    rig.late = on
    if not on:
        rig.burst()


def intrude(kind: str, rig: Rig) -> None:
    """Let somebody else onto the network."""
    rig.intrude(kind)


def released(rig: Rig) -> None:
    """Let it begin."""
    rig.intrusion.release()


def ended(rig: Rig) -> None:
    """Get rid of it."""
    rig.intrusion.end()


def blind(rig: Rig) -> None:
    """The camera is gone, and only somebody else publishes scans."""
    released(rig)
    rig.relay.mode = "dropped"


def sighted(rig: Rig) -> None:
    """The camera is back, and nobody else publishes scans."""
    ended(rig)
    rig.relay.mode = "pass"


def flood(rig: Rig) -> None:
    """Commands and requests without end; when they have come, an operator asks for a stop."""
    released(rig)
    end = rig.look().time + FLOODED
    while rig.step().time < end:
        pass
    rig.ask("stop")


def ebb(rig: Rig) -> None:
    """A flood ends, and somebody clears the stop."""
    ended(rig)
    rig.ask("clear_safety")


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
        "frames repeated": Fault(partial(frames, "repeated"), passing),
        "base clock stuck": Fault(partial(line, "clock off"), partial(line, "clock on")),
        "packets repeated": Fault(partial(line, "repeat on"), partial(line, "repeat off")),
        "encoders stuck": Fault(partial(encoders, 0.0), partial(encoders, 1.0)),
        "odometry at half": Fault(partial(encoders, 0.5), partial(encoders, 1.0), lasts=CREEPING),
        "slow port": Fault(partial(line, f"slow {SLOW}"), partial(line, "slow 0")),
        "commands in bursts": Fault(partial(late, True), partial(late, False)),
        "two drivers": Fault(released, ended, partial(intrude, "drive")),
        "flooded bus, then stop": Fault(flood, ebb, partial(intrude, "flood")),
        "scans from the future": Fault(blind, sighted, partial(intrude, "future")),
        "scans of two beams": Fault(blind, sighted, partial(intrude, "two_beams")),
        "driver silent": Fault(partial(quiet, True), partial(quiet, False)),
    }
