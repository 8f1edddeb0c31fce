"""The table, as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from benchmarks.falls.outcome import Outcome

HEADINGS = ("mode", "speed [m/s]", "worlds", "minutes", "falls", "falls / 1000 min", "cliff sensor", "bumps",
            "stranded", "visited", "median", "worst", "held", "without cause", "faster than real time")  # fmt: skip
NOTES = """\
falls: the robot tilted by more than 20 degrees or sank by 4 cm. cliff sensor: how often one fired, so that the base
backed off by itself. bumps: how often something began to push the hull. stranded: a robot that stood in one place for a
minute. A fallen or stranded robot's run is over.

visited: share of the reachable floor that the middle of the robot came within 30 cm of: all of it together, and the
runs' median and worst. Reachable are, by the world's geometry on a raster of 5 cm, the places to which a disc of 18 cm
radius can get from the start over floor and ramps.

held: share of the time in which the gate stopped a robot that was to drive. without cause: share of the time in which
it did so although the disc had 8 cm to spare (the gate's margin and its cells) on the next 0.5 m of the arc asked for.
"""


def report(outcomes: Sequence[Outcome], metres: float) -> str:
    """The table and what its words mean."""
    lines = []
    for mode in unique(outcome.case.mode for outcome in outcomes):
        of_mode = [outcome for outcome in outcomes if outcome.case.mode == mode]
        speeds = sorted({outcome.case.speed for outcome in of_mode})
        lines += [line(mode, f"{speed:g}", [each for each in of_mode if each.case.speed == speed]) for speed in speeds]
        lines.append(line(mode, "all", of_mode))
    note = f"A run lasts as long as {metres:.0f} m take at its speed."
    return "\n\n".join(["# Never fall", markdown(HEADINGS, lines), note, NOTES])


def line(mode: str, speed: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """The figures of some runs."""
    seconds = sum(outcome.seconds for outcome in outcomes)
    falls, cliffs, bumps, stranded = (
        sum(outcome.count(kind) for outcome in outcomes) for kind in ("fall", "cliff", "bump", "stranded")
    )
    shares = [outcome.visited for outcome in outcomes]
    return (
        *(mode, speed, str(len(outcomes)), f"{seconds / 60:.1f}"),
        *(str(falls), f"{falls / seconds * 60_000:.1f}", str(cliffs), str(bumps), str(stranded)),
        *(percent(sum(o.visited * o.area for o in outcomes) / sum(o.area for o in outcomes), 0),),
        *(percent(float(np.median(shares)), 0), percent(min(shares), 0)),
        *(percent(sum(o.held for o in outcomes) / seconds), percent(sum(o.idle for o in outcomes) / seconds)),
        f"{seconds / sum(o.wall for o in outcomes):.1f}",
    )


def percent(share: float, digits: int = 1) -> str:
    """A share as text."""
    return f"{100 * share:.{digits}f} %"


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the first column holds names."""
    rule = ["---", *("---:" for _ in headings[1:])]
    return "\n".join(f"| {' | '.join(row)} |" for row in (headings, rule, *rows))


def unique(items: Iterable[str]) -> list[str]:
    """The items in order, each once."""
    return list(dict.fromkeys(items))
