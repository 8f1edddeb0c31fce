"""The tables, as Markdown."""

from collections.abc import Iterable, Sequence

from benchmarks.accuracy.rows import DEFINITIONS, Census, Figures, Row
from benchmarks.accuracy.rows import Table as Results
from evaluation.score import WRONG, Tally, Verdict, ratio
from evaluation.tables import NONE, Table, number, percent, unique

HEADINGS = ("scan", "found", "missed", "late", "early", "false, safe", "false, drop", "median [m]", "95 % [m]",
            "95 % / allowed", "kerb", "clear beyond", "blind")  # fmt: skip


def report(table: Results, notes: Sequence[str] = (), folders: Sequence[str] = ()) -> str:
    """All tables, and what their words mean; notes: for below the title; folders: the sections of recorded frames."""
    title = "# Where the floor ends, against exact truth"
    return "\n\n".join([title, *notes, *sections(table), *by_kind(table), *folders, DEFINITIONS])


def sections(table: Results) -> Iterable[str]:
    """One table for each set and plane mode."""
    scans = unique(row.scan for row in table.rows)
    for group, plane in unique((row.case.group, row.plane) for row in table.rows):
        headings, lines = measured([(scan, *cells(table.figures(scan, group, plane))) for scan in scans])
        note = counted(table.chosen(group, plane, scans[0])) + undecided(table, group, plane, scans)
        yield Table(f"Setup {group}, plane {plane}", headings, lines, note=note).markdown(level=2)


def measured(lines: Sequence[Sequence[str]]) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
    """The headings and the lines without the columns in which no scan has a figure."""
    columns = zip(HEADINGS, zip(*lines, strict=True), strict=True)
    kept = [(heading, column) for heading, column in columns if {*column} != {NONE}]
    return [heading for heading, _ in kept], list(zip(*(column for _, column in kept), strict=True))


def counted(rows: Sequence[Row]) -> str:
    """How much was scored and how much was not."""
    drops, safe = (sum(row.case.safe is wanted for row in rows) for wanted in (False, True))
    all_of = Census.total([row.census for row in rows])
    left_out = ", ".join(
        f"{beams} {name} ({percent(ratio(beams, all_of.beams), 2)})"
        for name, beams in (("oblique", all_of.oblique), ("hidden", all_of.hidden), ("sinking", all_of.sinking))
    )
    return (
        f"{drops} scenes with drops and {safe} without: {all_of.beams} beams, {all_of.drop} of them drop beams. "
        f"Not counted: {left_out}."
    )


def undecided(table: Results, group: str, plane: str, scans: Sequence[str]) -> str:
    """How many of the undecidable beams report a number."""
    shares = []
    for scan in scans:
        rows = table.chosen(group, plane, scan)
        all_of, tally = Census.total([row.census for row in rows]), Tally.total([row.tally for row in rows])
        if all_of.hidden + all_of.sinking:
            of_each = (ratio(tally.hidden, all_of.hidden), ratio(tally.sinking, all_of.sinking))
            shares.append(f"{scan} {' and '.join(percent(share, 2) for share in of_each)}")
    return f" Of the hidden and the sinking report a number there: {', '.join(shares)}." if shares else ""


def by_kind(table: Results) -> Iterable[str]:
    """For each set and plane mode, what each scan gets wrong in each kind of scene."""
    scans = unique(row.scan for row in table.rows)
    for group, plane in unique((row.case.group, row.plane) for row in table.rows):
        kinds = unique(row.case.kind for row in table.chosen(group, plane, scans[0]))
        lines = [(kind, *(faults(table.chosen(group, plane, scan), kind) for scan in scans)) for kind in sorted(kinds)]
        title = f"By kind of scene, missed / late / early or false, of all beams: setup {group}, plane {plane}"
        yield Table(title, ("kind", *scans), lines).markdown(level=3)


def faults(rows: Sequence[Row], kind: str) -> str:
    """The shares of missed, late and false beams of one kind of scene."""
    tally = Tally.total([row.tally for row in rows if row.case.kind == kind])
    shares = (tally.share(chosen, tuple(Verdict)) for chosen in ((Verdict.MISSED,), (Verdict.LATE,), WRONG))
    return " / ".join(number(100 * share, ".2f") for share in shares)


def cells(figures: Figures) -> tuple[str, ...]:
    """Figures as text."""
    *shares, median, percentile95, relative95, kerb, clear_beyond, blind = figures
    errors = number(median, "+.3f"), number(percentile95, ".3f"), number(relative95, ".2f")
    last = (percent(share, 2) for share in (kerb, clear_beyond, blind))
    return (*(percent(share, 2) for share in shares), *errors, *last)
