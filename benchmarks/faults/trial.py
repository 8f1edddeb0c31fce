"""One fault at a random time of a drive: when the robot is at rest, whether it falls, whether it goes on."""

import math
import random
from collections.abc import Callable
from typing import NamedTuple

from benchmarks.faults.faults import Fault
from benchmarks.faults.rig import EDGE, Rig, Sample

HULL = 0.18  # [m] its radius
REST = 0.02  # [m/s] slower is at rest
GOING = 0.7  # of the speed that is asked for: it drives
GOES_ON = 0.05  # [m/s]
DRIVES = (0.2, 2.5)  # [s] for which it has driven when the fault comes
AFTER = 1.0  # [s] for which it must drive when the fault is over, or it has not gone on
GIVE_UP = 25.0  # [s] after which it does not any more


class Outcome(NamedTuple):
    """What became of the robot; times [s] of the simulation since the fault began, inf where it never came to that."""

    fault: str
    speed: float  # [m/s] when the fault began
    rest: float
    way: float  # [m] until then
    left: float  # [m] then, between its hull and the stairs' edge
    fell: bool
    on: float


def run_trial(rig: Rig, name: str, fault: Fault, rng: random.Random) -> Outcome:
    """Drive for a while, have the fault, see what comes of it."""
    fault.prepare(rig)
    before = started(rig, rng.uniform(*DRIVES))
    lasts = rng.uniform(*fault.lasts)
    fault.begin(rig)
    rested, last = until(rig, before.time + lasts, lambda sample: abs(sample.speed) < REST)
    if rested:
        _, last = until(rig, before.time + lasts, lambda _: False)
    fault.end(rig)
    moving, latest = until(rig, last.time + GIVE_UP, lambda sample: abs(sample.speed) > GOES_ON or sample.fallen)
    driving = None if latest.fallen else drive_for(rig, AFTER, latest.time + GIVE_UP)
    resting = (rested or last).pose
    fell = rig.look().fallen
    if fell:
        rig.put_back()
    return Outcome(
        name,
        before.speed,
        rested.time - before.time if rested else math.inf,
        math.dist(resting[:2], before.pose[:2]),
        EDGE - HULL - resting.x,
        fell,
        moving.time - before.time if moving and driving else math.inf,
    )


def started(rig: Rig, seconds: float) -> Sample:
    """Drive for so long [s]; a robot that does not is turned round once, as its user would. Raises RuntimeError."""
    for _ in range(2):
        driving = drive_for(rig, seconds, rig.look().time + GIVE_UP)
        if driving:
            return driving
        rig.turn_round()
    raise RuntimeError("the robot does not drive any more")


def drive_for(rig: Rig, seconds: float, end: float) -> Sample | None:
    """Drive until the robot has gone at its speed for so long in all [s], and does.

    None where it falls, or has not at the simulation's time `end` [s].
    """
    driven, last = 0.0, rig.step()
    while driven < seconds or not drives(rig, last):
        sample = rig.step()
        driven += sample.time - last.time if drives(rig, sample) else 0.0
        last = sample
        if last.fallen or last.time > end:
            return None
    return last


def drives(rig: Rig, sample: Sample) -> bool:
    """Whether the robot goes as fast as the driver wants, or nearly."""
    return sample.speed > GOING * rig.speed


def until(rig: Rig, end: float, holds: Callable[[Sample], bool]) -> tuple[Sample | None, Sample]:
    """The first sample of which `holds` is true; None where there is none before the simulation's time `end` [s].

    And the last sample, whatever it says.
    """
    while True:
        sample = rig.step()
        if holds(sample):
            return sample, sample
        if sample.time >= end:
            return None, sample
