"""The rows of results, and the figures over any of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from benchmarks.accuracy.cases import Case
from benchmarks.accuracy.figures import Figures
from benchmarks.accuracy.frames import KNOWN
from benchmarks.accuracy.score import Tally
from benchmarks.accuracy.truth import Truth

KERB = "kerb_5cm"


class Census(NamedTuple):
    """How many beams of some frames there are of each sort."""

    beams: int
    drop: int  # that must be found
    oblique: int  # that need not, because the edge runs along the beam
    hidden: int  # undecidable, and less than half a metre of the ramp is seen
    sinking: int  # undecidable, though more of it is seen

    @classmethod
    def of(cls, truths: Sequence[Truth]) -> Census:
        """The census of frames of these truths."""
        return cls(
            sum(len(truth.edge) for truth in truths),
            sum(int(truth.drop.sum()) for truth in truths),
            sum(int(truth.oblique.sum()) for truth in truths),
            sum(int((truth.undecidable & ~truth.sinking).sum()) for truth in truths),
            sum(int(truth.sinking.sum()) for truth in truths),
        )

    @classmethod
    def total(cls, parts: Sequence[Census]) -> Census:
        """All of them together."""
        return cls(*map(sum, zip(*parts, strict=True))) if parts else cls(0, 0, 0, 0, 0)


class Row(NamedTuple):
    """What one scan of a case came to in a plane mode, over all frames of it."""

    case: Case
    plane: str  # the plane mode, and whether it was tracked
    scan: str
    tally: Tally
    kerb: Tally  # the same where only kerbs of 5 cm up to 1.5 m away are drop beams
    census: Census


class Table(NamedTuple):
    """All rows."""

    rows: tuple[Row, ...]

    def chosen(self, group: str, plane: str, scan: str) -> list[Row]:
        """The rows of one scan in one set and plane mode."""
        return [row for row in self.rows if (row.case.group, row.plane, row.scan) == (group, plane, scan)]

    def figures(self, scan: str, group: str = "level", plane: str = KNOWN) -> Figures:
        """The figures of one scan in one set and plane mode."""
        rows = self.chosen(group, plane, scan)
        return Figures.of(
            [row.tally for row in rows if not row.case.safe],
            [row.tally for row in rows if row.case.safe],
            [row.kerb for row in rows if row.case.kind == KERB],
        )
