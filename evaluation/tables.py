"""Tables of results, the same for the terminal and as Markdown, and figures as text."""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from rich.box import SIMPLE_HEAD
from rich.table import Table as RichTable
from rich.text import Text

Item = TypeVar("Item")

NONE = "-"


class Table(NamedTuple):
    """Rows of text under headings; the columns from `numeric` on hold numbers. `note` is Markdown for below."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    numeric: int = 1
    note: str = ""

    def rich(self) -> RichTable:
        """For the terminal."""
        table = RichTable(box=SIMPLE_HEAD, collapse_padding=True, pad_edge=False)
        for place, heading in enumerate(self.headings):
            table.add_column(Text(heading), justify="right" if place >= self.numeric else "left", no_wrap=True)
        for row in self.rows:
            table.add_row(*map(Text, row))
        return table

    def markdown(self, level: int = 1) -> str:
        """For a file: the title as a heading of that level, the table and its note."""
        rule = ["---:" if place >= self.numeric else "---" for place in range(len(self.headings))]
        lines = "\n".join(f"| {' | '.join(cells)} |" for cells in (self.headings, rule, *self.rows))
        return "\n\n".join(part for part in (f"{'#' * level} {self.title}", lines, self.note) if part)


def write_csv(records: Iterable[Mapping[str, object]], path: Path) -> None:
    """Write records, of which there is at least one, as lines under the keys that they share."""
    first, *others = records
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(first))
        writer.writeheader()
        writer.writerows([first, *others])


def number(value: float, spec: str) -> str:
    """A figure as text, as the format specification has it."""
    return NONE if math.isnan(value) else f"{value:{spec}}"


def percent(share: float, digits: int = 1) -> str:
    """A share as text."""
    return number(100 * share, f".{digits}f") + ("" if math.isnan(share) else " %")


def unique(items: Iterable[Item]) -> list[Item]:
    """The items in order, each once."""
    return list(dict.fromkeys(items))
