"""The rows of results, one for every case, plane mode and scan, and the figures over any of them."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from benchmarks.accuracy.cases import Case
from benchmarks.accuracy.frames import KNOWN
from benchmarks.accuracy.setups import GLOSSY
from evaluation.score import ON_DROP, WRONG, Tally, Verdict, percentile, ratio
from evaluation.truth.beam_truth import Truth

DEFINITIONS = """\
*Drop beams* are those whose edge is in the sensor's sight (the three rows of floor before it are in the image and in
range, neither hidden nor in the shadow of an obstacle), at most 3.0 m away, with at least 20 cm of hole along the beam
and no obstacle in the way before it. *Allowed* is the larger of 2 cm and one row of the image, z²/(f·h).

- *found*: of the drop beams, those that report a number at or before edge + allowed.
- *missed*: of the drop beams, those that report no number.
- *late*: of the drop beams, those whose number is farther than edge + allowed.
- *early*: of all numbers before a drop, near or far, in sight or not: the share of those beams that report a number
  nearer than edge - 2 allowed - 5 cm.
- *false, safe*: of the beams of scenes without a drop, those that report a number.
- *false, drop*: of the beams of scenes with a drop that do not cross it and are not beside a beam that does.
- *error*: of the drop beams' numbers: reported less true distance, its median; the 95th percentile of its amount; and
  that of its amount over the allowed error.
- *kerb*: as found, of the drop beams of kerbs of 5 cm up to 1.5 m away.
- *clear beyond*: of the drop beams, those that tell floor to be clear farther than edge + allowed; "-" where a scan
  does not tell how far floor is clear.
- *blind*: of the beams over empty floor that have 20 cm of it within 3.0 m in the image and in range, those that report
  NaN.

The setups:

- *level*: a Kinect 0.30 m high; *mounted*: one 0.2 to 1.0 m high, pitched up to 35° and rolled up to 3°; *glossy*: as
  level, over floor with patches that return nothing, which no single frame tells from a hole.
- *rolled*: as mounted, at any roll. *stereo*: as mounted, a D4xx with 0.08 to 0.12 px of noise that neighbours share,
  and edges smeared. *flight*: as mounted, a time-of-flight camera. Their noise is told.
- *border*: as level or as mounted, with up to 23 rows and 15 columns at the border that return nothing, and are told.
- *ramps*: as level, ramps down of 3 to 5° whose crest is 2.8 to 3.2 m ahead and whose surface is seen from any angle.
- *corners* and *tips*: as level; the drop beams are those with 10 to 20 cm and with 5 to 10 cm of hole.
- *steps*: as level, straight steps down of 1.4 to 2.5 cm up to 1.5 m ahead, and steps of up to 1 cm that may be driven.
- *flat*: empty floor seen by a Kinect 0.2 to 1.5 m high, pitched -5 to 60°, at any roll.

Not counted, and how many they are, stands under each table:

- *oblique*: the edge runs so nearly along the beam that it moves by more than the allowed error between the beam's
  middle and its border. It is no drop beam; early numbers are counted.
- *hidden* and *sinking*, both undecidable: a ramp, or the floor behind its crest, goes out of the sensor's sight within
  its range: it would be seen at an angle whose sine is below 0.05, and returns nothing. What is left is what an edge of
  stairs shows. Numbers nearer than where it is lost (less 2 allowed and 5 cm) are false; the others are counted apart,
  for the beams that see less than half a metre of the ramp before (hidden), and for those that see more, from which a
  method could foresee where the ramp will be lost (sinking).
"""


class Sight(NamedTuple):
    """How many beams could see empty floor, and how many of them report that they saw nothing."""

    beams: int = 0
    unseen: int = 0

    @classmethod
    def total(cls, parts: Sequence[Self]) -> Self:
        """All of them together."""
        return cls(sum(part.beams for part in parts), sum(part.unseen for part in parts))

    @property
    def blind(self) -> float:
        """The share that saw nothing; NaN where none could see."""
        return ratio(self.unseen, self.beams)


class Figures(NamedTuple):
    """Shares of beams, and errors [m]; NaN where there is no beam to take them over."""

    found: float
    missed: float
    late: float
    early: float
    false_safe: float
    false_drop: float
    median: float  # [m]
    percentile95: float  # [m]
    relative95: float  # of the allowed error
    kerb: float
    clear_beyond: float
    blind: float

    @classmethod
    def of(cls, drops: Sequence[Tally], safe: Sequence[Tally], kerbs: Sequence[Tally], sights: Sequence[Sight]) -> Self:
        """The figures of scans of scenes with drops, of safe ones, of kerbs of 5 cm within 1.5 m, of empty floor."""
        drop, quiet, kerb = Tally.total(drops), Tally.total(safe), Tally.total(kerbs)
        wrong = (Verdict.FALSE, Verdict.ASTRAY)
        return cls(
            found=drop.share((Verdict.FOUND, Verdict.EARLY), ON_DROP),
            missed=drop.share((Verdict.MISSED,), ON_DROP),
            late=drop.share((Verdict.LATE,), ON_DROP),
            early=drop.share((Verdict.EARLY, Verdict.ASTRAY), (*ON_DROP, Verdict.ASTRAY, Verdict.UNCOUNTED)),
            false_safe=quiet.share(wrong, (*wrong, Verdict.QUIET)),
            false_drop=drop.share((Verdict.FALSE,), (Verdict.FALSE, Verdict.QUIET)),
            median=percentile(drop.errors, 50),
            percentile95=percentile(np.abs(drop.errors), 95),
            relative95=percentile(np.abs(drop.relative), 95),
            kerb=kerb.share((Verdict.FOUND, Verdict.EARLY), ON_DROP),
            clear_beyond=ratio(drop.beyond, drop.telling),
            blind=Sight.total(sights).blind,
        )


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
    sight: Sight  # where there is nothing but floor

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
            "in_sight": self.sight.beams,
            "blind": self.sight.unseen,
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
            [row.sight for row in rows],
        )


def worst(rows: Sequence[Row], scan: str, plane: str, most: int) -> list[Row]:
    """The cases in which a scan is wrong most, the worst first, in one plane mode; glossy floors are not among them."""
    asked = [row for row in rows if (row.scan, row.plane) == (scan, plane) and row.case.kind != GLOSSY]
    return sorted((row for row in asked if row.wrong > 0.0), key=lambda row: row.wrong, reverse=True)[:most]
