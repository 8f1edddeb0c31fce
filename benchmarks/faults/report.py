"""The outcomes of all trials as a table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median

from benchmarks.faults.trial import Outcome

HEADINGS = (
    "fault",
    "trials",
    "at rest after [s], median",
    "max",
    "way [m], max",
    "left to the edge [m], min",
    "fell",
    "went on",
    "after [s], median",
)


def table(outcomes: Sequence[Outcome]) -> str:
    """A row for each fault, and one for all, in Markdown."""
    names = list(dict.fromkeys(outcome.fault for outcome in outcomes))
    rows = [row(name, [outcome for outcome in outcomes if outcome.fault == name]) for name in sorted(names)]
    rule = ["---", *("---:" for _ in HEADINGS[1:])]
    cells = [HEADINGS, rule, *rows, row("all", outcomes)]
    return "\n".join(f"| {' | '.join(line)} |" for line in cells)


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
