"""The rows of results, one for every case, plane mode and scan, and the figures over any of them."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from benchmarks.accuracy.cases import GLOSSY, Case
from benchmarks.accuracy.figures import Figures
from benchmarks.accuracy.frames import KNOWN
from evaluation.score import WRONG, Tally, Verdict, percentile
from evaluation.truth.beam_truth import Truth

KERB = "kerb_5cm"


class Census(NamedTuple):
    """How many beams of some frames there are of each sort."""

    beams: int
    drop: int  # that must be found
    oblique: int  # that need not, because the edge runs along the beam
    hidden: int  # undecidable, and less than half a metre of the ramp is seen
    sinking: int  # undecidable, though more of it is seen

    @classmethod
    def of(cls, truths: Sequence[Truth]) -> Self:
        """The census of frames of these truths."""
        return cls(
            sum(len(truth.edge) for truth in truths),
            sum(int(truth.drop.sum()) for truth in truths),
            sum(int(truth.oblique.sum()) for truth in truths),
            sum(int((truth.undecidable & ~truth.sinking).sum()) for truth in truths),
            sum(int(truth.sinking.sum()) for truth in truths),
        )

    @classmethod
    def total(cls, parts: Sequence[Self]) -> Self:
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

    @property
    def wrong(self) -> float:
        """The share of its beams that are wrong in any way."""
        return self.tally.share((*WRONG, Verdict.LATE, Verdict.MISSED), tuple(Verdict))

    def record(self) -> dict[str, str | float]:
        """The columns of a file: beams of each verdict and sort, errors [m]."""
        return {
            "case": self.case.name,
            "plane": self.plane,
            "scan": self.scan,
            "wrong": round(self.wrong, 5),
            **{verdict.name.lower(): self.tally.count(verdict) for verdict in Verdict},
            **self.census._asdict(),
            "error_median": round(percentile(self.tally.errors, 50), 4),
            "error_95": round(percentile(np.abs(self.tally.errors), 95), 4),
            "allowed_95": round(percentile(np.abs(self.tally.relative), 95), 3),
        }


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


def worst(rows: Sequence[Row], scan: str, plane: str, most: int) -> list[Row]:
    """The cases in which a scan is wrong most, the worst first, in one plane mode; glossy floors are not among them."""
    asked = [row for row in rows if (row.scan, row.plane) == (scan, plane) and row.case.kind != GLOSSY]
    return sorted((row for row in asked if row.wrong > 0.0), key=lambda row: row.wrong, reverse=True)[:most]
