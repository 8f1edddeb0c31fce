"""A line for every case, plane mode and scan, so that the worst can be found and replayed."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.accuracy.cases import GLOSSY
from benchmarks.accuracy.rows import Row
from benchmarks.accuracy.score import Verdict, percentile

WRONG = (Verdict.FALSE, Verdict.EARLY, Verdict.LATE, Verdict.MISSED, Verdict.ASTRAY)


def wrong(row: Row) -> float:
    """The share of a row's beams that are wrong in any way."""
    return row.tally.share(WRONG, tuple(Verdict))


def worst(rows: Sequence[Row], scan: str, plane: str, most: int) -> list[Row]:
    """The cases in which a scan is wrong most, the worst first, in one plane mode; glossy floors are not among them."""
    asked = [row for row in rows if (row.scan, row.plane) == (scan, plane) and row.case.kind != GLOSSY]
    found = [row for row in asked if wrong(row) > 0.0]
    return sorted(found, key=wrong, reverse=True)[:most]


def record(row: Row) -> dict[str, str | float]:
    """A row as columns of a file: beams of each verdict and sort, errors [m]."""
    return {
        "case": row.case.name,
        "plane": row.plane,
        "scan": row.scan,
        "wrong": round(wrong(row), 5),
        **{verdict.name.lower(): row.tally.count(verdict) for verdict in Verdict},
        **row.census._asdict(),
        "error_median": round(percentile(row.tally.errors, 50), 4),
        "error_95": round(percentile(np.abs(row.tally.errors), 95), 4),
        "allowed_95": round(percentile(np.abs(row.tally.relative), 95), 3),
    }


def write_csv(rows: Sequence[Row], path: Path) -> None:
    """Write all rows."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(record(rows[0])))
        writer.writeheader()
        writer.writerows(map(record, rows))
