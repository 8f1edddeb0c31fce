"""The outcomes of all trials as a table."""

import math
from collections.abc import Sequence
from statistics import median

from benchmarks.faults.trial import Outcome
from evaluation.tables import Table, unique

HEADINGS = ("fault", "trials", "at rest after [s], median", "max", "way [m], max", "left to the edge [m], min", "fell",
            "went on", "after [s], median")  # fmt: skip


def table(outcomes: Sequence[Outcome]) -> Table:
    """A row for each fault, and one for all."""
    names = sorted(unique(outcome.fault for outcome in outcomes))
    rows = [row(name, [outcome for outcome in outcomes if outcome.fault == name]) for name in names]
    return Table("Faults while driving", HEADINGS, [*rows, row("all", outcomes)])


def row(name: str, outcomes: Sequence[Outcome]) -> list[str]:
    """The figures of these outcomes."""
    rests = [outcome.rest for outcome in outcomes]
    ons = [outcome.on for outcome in outcomes if math.isfinite(outcome.on)]
    return [
        name,
        str(len(outcomes)),
        seconds(median(rests)),
        seconds(max(rests)),
        f"{max(outcome.way for outcome in outcomes):.2f}",
        f"{min(outcome.left for outcome in outcomes):.2f}",
        str(sum(outcome.fell for outcome in outcomes)),
        str(len(ons)),
        seconds(median(ons)) if ons else "-",
    ]


def seconds(value: float) -> str:
    """A time [s]; never, where it is infinite."""
    return f"{value:.2f}" if math.isfinite(value) else "never"
