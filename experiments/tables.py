"""Tables of results, the same for the terminal and as Markdown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from rich.box import SIMPLE_HEAD
from rich.table import Table as RichTable
from rich.text import Text

from experiments.map_score import DEFINITIONS as MAP_DEFINITIONS
from experiments.map_score import MapScore
from experiments.score import DEFINITIONS, Census, Score

EDGE_HEADINGS = ("world", "scan", "median [m]", "95 % [m]", "missed", "late", "false")
CENSUS_HEADINGS = ("scan", "number", "free (inf)", "not seen (NaN)", "median [m]")
CENSUS_NOTE = """\
Shares of all beams: those with a number, those that looked and found nothing,
those that did not see. The median is that of the numbers.
"""
MAP_HEADINGS = ("map of", "free beyond", "blocked", "edges", "rms", "final")
MAP_NAMES = {"positive": "positive, fig. 24", "paper": "the paper's, fig. 25", "fused": "fused (ours)"}
NONE = "-"


class Table(NamedTuple):
    """Rows of text under headings; the columns from `numeric` on hold numbers. `note` is Markdown for below."""

    title: str
    headings: Sequence[str]
    rows: Sequence[tuple[str, ...]]
    numeric: int
    note: str = ""

    def rich(self) -> RichTable:
        """For the terminal."""
        table = RichTable(box=SIMPLE_HEAD, collapse_padding=True, pad_edge=False)
        for place, heading in enumerate(self.headings):
            table.add_column(Text(heading), justify="right" if place >= self.numeric else "left", no_wrap=True)
        for row in self.rows:
            table.add_row(*map(Text, row))
        return table

    def markdown(self) -> str:
        """For a file."""
        rule = ["---:" if place >= self.numeric else "---" for place in range(len(self.headings))]
        lines = [f"| {' | '.join(cells)} |" for cells in (self.headings, rule, *self.rows)]
        return "\n".join([f"# {self.title}", "", *lines, "", self.note])


def edge_table(scores: Mapping[str, Mapping[str, Score]], frames: int, methods: Sequence[str]) -> Table:
    """How well each scan finds the edge of the hole, by world and scan; methods: those that `negative` combined."""
    rows = [
        (world, scan, _metres(each.median), _metres(each.percentile95), *map(_percent, each[2:]))
        for world, by_scan in scores.items()
        for scan, each in by_scan.items()
    ]
    title = f"Where the floor ends, against the truth: {frames} frames of each world"
    combined = f"`negative`, and with it `fused`, combined {', '.join(methods)}:\nthey are as false as any of these.\n"
    return Table(title, EDGE_HEADINGS, rows, 2, f"{combined}\n{DEFINITIONS}")


def census_table(title: str, counts: Mapping[str, Census]) -> Table:
    """What each scan reports."""
    rows = [
        (scan, _percent(each.number), _percent(each.free), _percent(each.unseen), _metres(each.median, ""))
        for scan, each in counts.items()
    ]
    return Table(title, CENSUS_HEADINGS, rows, 1, CENSUS_NOTE)


def map_table(scores: Mapping[str, MapScore], drive: str) -> Table:
    """How good each map is; `drive` tells in a few words what it was made of."""
    rows = [
        (
            MAP_NAMES.get(name, name),
            f"{each.free_beyond:.2f} m²",
            f"{each.blocked:.2f} m²",
            _percent(each.edges),
            f"{100 * each.rms:.1f} cm",
            f"{100 * each.final:.1f} cm",
        )
        for name, each in scores.items()
    ]
    return Table(f"The same drive mapped from three scans: {drive}", MAP_HEADINGS, rows, 1, MAP_DEFINITIONS)


def _metres(value: float, sign: str = "+") -> str:
    return NONE if math.isnan(value) else f"{value:{sign}.3f}"


def _percent(share: float) -> str:
    return NONE if math.isnan(share) else f"{100 * share:.1f} %"
