"""How well scans find where the floor ends, in figures and tables."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from cliffscan.common.contract.beam_fields import Beams
from evaluation.score import ON_DROP, WRONG, Tally, Verdict, percentile
from evaluation.tables import Table, number, percent
from evaluation.truth.beam_truth import Truth
from evaluation.truth.world_truth import TOLERANCE

DEFINITIONS = f"""\
A beam has an edge where the floor truly ends by a drop, with no obstacle before
it, and the sensor could measure a point there: within its image and its range.

- *error*: reported less true distance, over the beams with an edge that report
  a number; positive is too far. Its median and its 95th percentile [m].
- *missed*: of the beams with an edge, those that report no number.
- *late*: of the beams with an edge, those whose number is more than
  {100 * TOLERANCE:.0f} cm too far.
- *false*: of all beams, those whose number is more than {100 * TOLERANCE:.0f} cm nearer than what
  truly comes first: an edge, within the sensor's reach or not, or an obstacle
  at the heights of the robot's body. Where there is neither, every number is
  false: a method that reports how far it saw floor is charged for it.

`paper` combines farthest_point and virtual_floor (algorithm 3).
"""
EDGE_HEADINGS = ("world", "scan", "median [m]", "95 % [m]", "missed", "late", "false")


class Score(NamedTuple):
    """The measures of DEFINITIONS; NaN where there is no beam to take them over."""

    median: float  # [m]
    percentile95: float  # [m]
    missed: float  # share of the beams with an edge
    late: float  # share of the beams with an edge
    false: float  # share of all beams


def score(scans: Sequence[Beams], truth: Truth) -> Score:
    """The score of scans of one view, by DEFINITIONS."""
    tally = Tally.total([Tally.of(scan, truth) for scan in scans])
    return Score(
        median=percentile(tally.errors, 50),
        percentile95=percentile(tally.errors, 95),
        missed=tally.share((Verdict.MISSED,), ON_DROP),
        late=tally.share((Verdict.LATE,), ON_DROP),
        false=tally.share(WRONG, tuple(Verdict)),
    )


def edge_table(scores: Mapping[str, Mapping[str, Score]], frames: int, methods: Sequence[str]) -> Table:
    """How well each scan finds the edge of the hole, by world and scan; methods: those that `negative` combined."""
    rows = [
        (world, scan, number(each.median, "+.3f"), number(each.percentile95, "+.3f"), *map(percent, each[2:]))
        for world, by_scan in scores.items()
        for scan, each in by_scan.items()
    ]
    title = f"Where the floor ends, against the truth: {frames} frames of each world"
    combined = f"`fused` combines positive with {', '.join(methods)}.\n"
    return Table(title, EDGE_HEADINGS, rows, 2, f"{combined}\n{DEFINITIONS}")
