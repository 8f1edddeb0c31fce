"""Files of the runs and of what happened in them, each with the name by which --only replays it."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path

from benchmarks.falls.outcome import Event, Outcome


def run_record(outcome: Outcome) -> dict[str, str | float]:
    """A run as columns of a file: times [s] and counts."""
    case, seconds, wall, events, area, visited, held, idle = outcome
    kinds = [event.kind for event in events]
    return {
        "case": case.name,
        "world": case.world,
        "seconds": round(seconds, 2),
        "wall": round(wall, 2),
        "area": round(area, 2),
        "visited": round(visited, 4),
        "held": round(held, 2),
        "without_cause": round(idle, 2),
        **{kind: kinds.count(kind) for kind in ("fall", "cliff", "bump", "stranded")},
    }


def event_record(outcome: Outcome, event: Event) -> dict[str, str | float]:
    """An event: time [s], true pose [m, rad]."""
    values = {key: value if isinstance(value, str) else round(value, 3) for key, value in event._asdict().items()}
    return {"case": outcome.case.name, "world": outcome.case.world, "mode": outcome.case.mode, **values}


def write(outcomes: Sequence[Outcome], folder: Path) -> None:
    """Write runs.csv and events.json."""
    with (folder / "runs.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, list(run_record(outcomes[0])))
        writer.writeheader()
        writer.writerows(map(run_record, outcomes))
    events = [event_record(outcome, event) for outcome in outcomes for event in outcome.events]
    (folder / "events.json").write_text("[\n" + ",\n".join(map(json.dumps, events)) + "\n]\n")
