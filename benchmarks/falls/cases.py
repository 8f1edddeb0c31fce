"""The runs: which robot, what it sees by, how fast it wants to go, and in which random world."""

import argparse
from collections.abc import Sequence
from typing import NamedTuple, Self, get_args

from benchmarks.falls.bases import Base
from benchmarks.falls.perception import Mode

WIDE = 1.2  # [m] left free around each thing for a robot that needs 0.96 m to turn on the spot


class Case(NamedTuple):
    """A run: the world `random:<seed>`, and everything random in the run, follow from the seed."""

    mode: Mode
    speed: float  # [m/s] that the driver asks for
    seed: int
    base: Base = "turtlebot2"

    @property
    def name(self) -> str:
        """How --only names it."""
        base = "" if self.base == "turtlebot2" else f":{self.base}"
        return f"{self.mode}:{self.speed:g}:{self.seed}{base}"

    @property
    def file_name(self) -> str:
        """The name, where a colon is no good."""
        return self.name.replace(":", "-")

    @property
    def world(self) -> str:
        """The simulator's name of its world."""
        passage = "" if self.base == "turtlebot2" else f":{WIDE}"
        return f"random:{self.seed}{passage}"

    @classmethod
    def parse(cls, text: str) -> Self:
        """The case of that name. Raises ArgumentTypeError where it is none."""
        mode, *numbers = text.split(":")
        try:
            speed, seed, *base = numbers
            base = base or ["turtlebot2"]
            (known,) = (each for each in get_args(Base) if [each] == base)
            return cls(next(each for each in get_args(Mode) if each == mode), float(speed), int(seed), known)
        except (ValueError, StopIteration):
            raise argparse.ArgumentTypeError(f"{text!r}, expected MODE:SPEED:SEED or MODE:SPEED:SEED:BASE") from None


def all_cases(modes: Sequence[Mode], speeds: Sequence[float], worlds: int, first: int, base: Base) -> list[Case]:
    """The worlds from a seed on, shared by the speeds; every mode runs in each of them before the next one."""
    return [Case(mode, speeds[world % len(speeds)], first + world, base) for world in range(worlds) for mode in modes]


def length(minutes: float, worlds: int, speeds: Sequence[float]) -> float:
    """How far [m] a robot that is never held gets in each run, where all runs of a mode take some minutes together."""
    return 60.0 * minutes / sum(1.0 / speeds[world % len(speeds)] for world in range(worlds))
