"""The tables, as Markdown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TypeVar

from benchmarks.accuracy.figures import DEFINITIONS, Figures
from benchmarks.accuracy.rows import Census, Row, Table
from benchmarks.accuracy.score import Tally, Verdict, ratio

Item = TypeVar("Item")

NONE = "-"
HEADINGS = ("scan", "found", "missed", "late", "early", "false, safe", "false, drop", "median [m]", "95 % [m]",
            "95 % / allowed", "kerb", "clear beyond")  # fmt: skip


def report(table: Table) -> str:
    """All tables, and what their words mean."""
    return "\n\n".join(["# Where the floor ends, against exact truth", *sections(table), *by_kind(table), DEFINITIONS])


def sections(table: Table) -> Iterable[str]:
    """One table for each set and plane mode."""
    scans = unique(row.scan for row in table.rows)
    for group, plane in unique((row.case.group, row.plane) for row in table.rows):
        lines = [(scan, *cells(table.figures(scan, group, plane))) for scan in scans]
        note = counted(table.chosen(group, plane, scans[0])) + undecided(table, group, plane, scans)
        yield f"## Camera {group}, plane {plane}\n\n{markdown(HEADINGS, lines)}\n\n{note}"


def counted(rows: Sequence[Row]) -> str:
    """How much was scored and how much was not."""
    drops, safe = (sum(row.case.safe is wanted for row in rows) for wanted in (False, True))
    all_of = Census.total([row.census for row in rows])
    left_out = ", ".join(
        f"{beams} {name} ({percent(ratio(beams, all_of.beams))})"
        for name, beams in (("oblique", all_of.oblique), ("hidden", all_of.hidden), ("sinking", all_of.sinking))
    )
    return (
        f"{drops} scenes with drops and {safe} without: {all_of.beams} beams, {all_of.drop} of them drop beams. "
        f"Not counted: {left_out}."
    )


def undecided(table: Table, group: str, plane: str, scans: Sequence[str]) -> str:
    """How many of the undecidable beams report a number."""
    shares = []
    for scan in scans:
        rows = table.chosen(group, plane, scan)
        all_of, tally = Census.total([row.census for row in rows]), Tally.total([row.tally for row in rows])
        if all_of.hidden + all_of.sinking:
            of_each = (ratio(tally.hidden, all_of.hidden), ratio(tally.sinking, all_of.sinking))
            shares.append(f"{scan} {' and '.join(map(percent, of_each))}")
    return f" Of the hidden and the sinking report a number there: {', '.join(shares)}." if shares else ""


def by_kind(table: Table) -> Iterable[str]:
    """For each set and plane mode, what each scan gets wrong in each kind of scene."""
    scans = unique(row.scan for row in table.rows)
    for group, plane in unique((row.case.group, row.plane) for row in table.rows):
        kinds = unique(row.case.kind for row in table.chosen(group, plane, scans[0]))
        lines = [(kind, *(faults(table.chosen(group, plane, scan), kind) for scan in scans)) for kind in sorted(kinds)]
        yield (
            f"### By kind of scene: camera {group}, plane {plane}\n\n"
            f"missed / late / early or false, of all beams\n\n{markdown(('kind', *scans), lines)}"
        )


def faults(rows: Sequence[Row], kind: str) -> str:
    """The shares of missed, late and false beams of one kind of scene."""
    tally = Tally.total([row.tally for row in rows if row.case.kind == kind])
    wrong = (Verdict.FALSE, Verdict.EARLY, Verdict.ASTRAY)
    return " / ".join(
        percent(tally.share(chosen, tuple(Verdict)), "") for chosen in ((Verdict.MISSED,), (Verdict.LATE,), wrong)
    )


def cells(figures: Figures) -> tuple[str, ...]:
    """Figures as text."""
    shares = figures[:6]
    relative = NONE if math.isnan(figures.relative95) else f"{figures.relative95:.2f}"
    return (
        *(percent(share) for share in shares),
        metres(figures.median, "+"),
        metres(figures.percentile95),
        relative,
        percent(figures.kerb),
        percent(figures.clear_beyond),
    )


def percent(share: float, unit: str = " %") -> str:
    """A share as text."""
    return NONE if math.isnan(share) else f"{100 * share:.2f}{unit}"


def metres(value: float, sign: str = "") -> str:
    """A length as text."""
    return NONE if math.isnan(value) else f"{value:{sign}.3f}"


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the first column holds names."""
    rule = ["---", *("---:" for _ in headings[1:])]
    return "\n".join(f"| {' | '.join(line)} |" for line in (headings, rule, *rows))


def unique(items: Iterable[Item]) -> list[Item]:
    """The items in order, each once."""
    return list(dict.fromkeys(items))
