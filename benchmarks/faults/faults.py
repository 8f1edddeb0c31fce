"""What can go wrong, by name: how it begins, how it ends.

A base whose line is cut obeys its last command, for nobody can tell it to stop, and the
emulated firmware has no timeout of its own, as the real one may not have either.
"""

import signal
from collections.abc import Callable
from typing import NamedTuple

from benchmarks.faults.frame_relay import Mode
from benchmarks.faults.rig import Rig
from cliffscan.common.runtime.config import SERVICES

PROCESSES = ("router", *SERVICES)
CUT = 1.5  # [s] of the serial line
CREEPING = (4.0, 8.0)  # [s] of a fault that shows on the way only
FLOODED = 0.3  # [s] of a flood before the stop
SLOW = 1200  # [bytes/s] of a slow one, a tenth of the real one

Deed = Callable[[Rig], object]


def nothing(rig: Rig) -> None:
    """What has to be done where something else does it."""


class Fault(NamedTuple):
    """How a fault begins, and how it is taken back after a while; a process that was killed is started anew anyway."""

    begin: Deed
    end: Deed
    prepare: Deed = nothing  # before the robot drives: what takes a while to start
    lasts: tuple[float, float] = (1.2, 2.5)  # [s] from its beginning to its end


def sent(name: str, number: signal.Signals) -> Deed:
    """Send a signal to a process."""
    return lambda rig: rig.send(name, number)


def started(name: str) -> Deed:
    """Start a process."""
    return lambda rig: rig.start(name)


def frames(mode: Mode) -> Deed:
    """Have the frames come so from now on."""
    return lambda rig: rig.relay.become(mode)


def line(command: str) -> Deed:
    """Have something done to the serial line."""
    return lambda rig: rig.remote.tell(command)


def intruder(kind: str) -> Deed:
    """Let somebody else onto the network."""
    return lambda rig: rig.intrude(kind)


def quiet(rig: Rig) -> None:
    """Have the driver publish nothing."""
    rig.quiet = True


def loud(rig: Rig) -> None:
    """Have it go on."""
    rig.quiet = False


def late(rig: Rig) -> None:
    """Hold the driver's commands back, and let them arrive in bursts."""
    rig.late = True


def prompt(rig: Rig) -> None:
    """Let them through again."""
    rig.late = False
    rig.burst()


def counting(rig: Rig) -> None:
    """Have the encoders count the whole way; what the gate no longer believes, an operator clears."""
    rig.remote.tell("encoders 1.0 1.0")
    rig.ask("clear_safety")


def released(rig: Rig) -> None:
    """Let the intruder begin."""
    rig.intrusion.release()


def ended(rig: Rig) -> None:
    """Get rid of it."""
    rig.intrusion.end()


def blind(rig: Rig) -> None:
    """The camera is gone, and only somebody else publishes scans."""
    released(rig)
    rig.relay.become("dropped")


def sighted(rig: Rig) -> None:
    """The camera is back, and nobody else publishes scans."""
    ended(rig)
    rig.relay.become("pass")


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
        found[f"{name} killed"] = Fault(sent(name, signal.SIGKILL), nothing)
        found[f"{name} stopped"] = Fault(sent(name, signal.SIGSTOP), sent(name, signal.SIGCONT))
        found[f"{name} restarted"] = Fault(sent(name, signal.SIGTERM), started(name))
    return found | {
        "frames late": Fault(frames("late"), frames("pass")),
        "frames frozen": Fault(frames("frozen"), frames("pass")),
        "frames dropped": Fault(frames("dropped"), frames("pass")),
        "line cut": Fault(line(f"unplug {CUT}"), nothing),
        "line mute": Fault(line(f"pause {CUT}"), nothing),
        "frames repeated": Fault(frames("repeated"), frames("pass")),
        "base clock stuck": Fault(line("clock off"), line("clock on")),
        "packets repeated": Fault(line("repeat on"), line("repeat off")),
        "encoders stuck": Fault(line("encoders 0.0 0.0"), counting),
        "odometry at half": Fault(line("encoders 0.5 0.5"), counting, lasts=CREEPING),
        "slow port": Fault(line(f"slow {SLOW}"), line("slow 0")),
        "commands in bursts": Fault(late, prompt),
        "two drivers": Fault(released, ended, intruder("drive")),
        "flooded bus, then stop": Fault(flood, ebb, intruder("flood")),
        "scans from the future": Fault(blind, sighted, intruder("future")),
        "scans of two beams": Fault(blind, sighted, intruder("two_beams")),
        "driver silent": Fault(quiet, loud),
    }
