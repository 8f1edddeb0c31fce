"""What can go wrong, by name: how it begins, how it ends.

A base whose line is cut obeys its last command, for nobody can tell it to stop, and the
emulated firmware has no timeout of its own, as the real one may not have either.
"""

import signal
from collections.abc import Callable
from typing import NamedTuple

from benchmarks.faults.frame_relay import Mode
from benchmarks.faults.intruder import Kind
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


def line(command: str) -> Deed:
    """Have something done to the serial line."""
    return lambda rig: rig.robot.remote.tell(command)


def of_process(name: str) -> dict[str, Fault]:
    """What can become of a process."""
    return {
        f"{name} killed": Fault(lambda rig: rig.send(name, signal.SIGKILL), nothing),
        f"{name} stopped": Fault(
            lambda rig: rig.send(name, signal.SIGSTOP), lambda rig: rig.send(name, signal.SIGCONT)
        ),
        f"{name} restarted": Fault(lambda rig: rig.send(name, signal.SIGTERM), lambda rig: rig.start(name)),
    }


def of_frames(mode: Mode) -> Fault:
    """Frames that do not come as they should."""
    return Fault(lambda rig: rig.relay.become(mode), lambda rig: rig.relay.become("pass"))


def of_intruder(kind: Kind, begin: Deed, end: Deed) -> Fault:
    """Somebody else on the network."""
    return Fault(begin, end, lambda rig: rig.intrude(kind))


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
    rig.robot.remote.tell("encoders 1.0 1.0")
    rig.robot.ask("clear_safety")


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
    rig.robot.ask("stop")


def ebb(rig: Rig) -> None:
    """A flood ends, and somebody clears the stop."""
    ended(rig)
    rig.robot.ask("clear_safety")


def known_faults() -> dict[str, Fault]:
    """All faults by name."""
    found: dict[str, Fault] = {}
    for name in PROCESSES:
        found |= of_process(name)
    return found | {
        "frames late": of_frames("late"),
        "frames frozen": of_frames("frozen"),
        "frames dropped": of_frames("dropped"),
        "line cut": Fault(line(f"unplug {CUT}"), nothing),
        "line mute": Fault(line(f"pause {CUT}"), nothing),
        "frames repeated": of_frames("repeated"),
        "base clock stuck": Fault(line("clock off"), line("clock on")),
        "packets repeated": Fault(line("repeat on"), line("repeat off")),
        "encoders stuck": Fault(line("encoders 0.0 0.0"), counting),
        "odometry at half": Fault(line("encoders 0.5 0.5"), counting, lasts=CREEPING),
        "slow port": Fault(line(f"slow {SLOW}"), line("slow 0")),
        "commands in bursts": Fault(late, prompt),
        "two drivers": of_intruder("drive", released, ended),
        "flooded bus, then stop": of_intruder("flood", flood, ebb),
        "scans from the future": of_intruder("future", blind, sighted),
        "scans of two beams": of_intruder("two_beams", blind, sighted),
        "driver silent": Fault(quiet, loud),
    }
