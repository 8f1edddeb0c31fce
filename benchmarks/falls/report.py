"""The table, and files of the runs and of what happened in them, each with the name by which --only replays it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import numpy as np

from benchmarks.falls.log import Event, Kind, Outcome
from evaluation.tables import Table, percent, unique, write_csv

HEADINGS = ("mode", "speed [m/s]", "worlds", "minutes", "falls", "falls / 1000 min", "cliff sensor", "bumps",
            "stranded", "visited", "median", "worst", "held", "without cause", "faster than real time")  # fmt: skip
KINDS: tuple[Kind, ...] = get_args(Kind)
NOTES = """\
falls: the robot tilted by more than 20 degrees (differential_large: 10) or sank by 4 cm. cliff sensor: how often one
fired, so that the base backed off by itself, or without one, a wheel or a caster had no floor below it. bumps: how
often something began to push the hull. stranded: a robot that stood in one place for a minute. A fallen or stranded
robot's run is over.

visited: share of the reachable floor that the middle of the robot came within 30 cm of: all of it together, and the
runs' median and worst. Reachable are, by the world's geometry on a raster of 5 cm, the places to which a disc of 18 cm
radius (differential_large: 25 cm, less than its turning circle) can get from the start over floor and ramps.

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
    note = f"A run lasts as long as {metres:.0f} m take at its speed.\n\n{NOTES}"
    return Table("Never fall", HEADINGS, lines, note=note).markdown()


def line(mode: str, speed: str, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """The figures of some runs."""
    seconds = sum(outcome.seconds for outcome in outcomes)
    counts = {kind: sum(outcome.count(kind) for outcome in outcomes) for kind in KINDS}
    shares = [outcome.visited for outcome in outcomes]
    return (
        *(mode, speed, str(len(outcomes)), f"{seconds / 60:.1f}"),
        *(str(counts["fall"]), f"{counts['fall'] / seconds * 60_000:.1f}"),
        *(str(counts[kind]) for kind in KINDS[1:]),
        *(percent(sum(o.visited * o.area for o in outcomes) / sum(o.area for o in outcomes), 0),),
        *(percent(float(np.median(shares)), 0), percent(min(shares), 0)),
        *(percent(sum(o.held for o in outcomes) / seconds), percent(sum(o.idle for o in outcomes) / seconds)),
        f"{seconds / sum(o.wall for o in outcomes):.1f}",
    )


def run_record(outcome: Outcome) -> dict[str, str | float]:
    """A run as columns of a file: times [s] and counts."""
    return {
        "case": outcome.case.name,
        "world": outcome.case.world,
        "seconds": round(outcome.seconds, 2),
        "wall": round(outcome.wall, 2),
        "area": round(outcome.area, 2),
        "visited": round(outcome.visited, 4),
        "held": round(outcome.held, 2),
        "without_cause": round(outcome.idle, 2),
        **{kind: outcome.count(kind) for kind in KINDS},
    }


def event_record(outcome: Outcome, event: Event) -> dict[str, str | float]:
    """An event: time [s], true pose [m, rad]."""
    values = {key: value if isinstance(value, str) else round(value, 3) for key, value in event._asdict().items()}
    return {"case": outcome.case.name, "world": outcome.case.world, "mode": outcome.case.mode, **values}


def write(outcomes: Sequence[Outcome], folder: Path) -> None:
    """Write runs.csv and events.json."""
    write_csv(map(run_record, outcomes), folder / "runs.csv")
    events = [event_record(outcome, event) for outcome in outcomes for event in outcome.events]
    (folder / "events.json").write_text("[\n" + ",\n".join(map(json.dumps, events)) + "\n]\n")
