"""The verdict on each beam of a scan, and what the verdicts of many scans come to."""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Beams
from evaluation.truth.beam_truth import Truth

Ranges = NDArray[np.floating[Any]]
Verdicts = NDArray[np.int8]


class Verdict(IntEnum):
    """What a beam's report is worth."""

    UNCOUNTED = 0  # a drop that need not be found, or a ramp out of sight: any number there or beyond will do
    QUIET = 1  # no drop, no number
    FALSE = 2  # no drop, a number
    FOUND = 3  # the drop, no later than allowed and no earlier than where a number is false
    EARLY = 4  # the drop, but much nearer than it is
    LATE = 5  # the drop, but farther than it is
    MISSED = 6  # the drop, no number
    ASTRAY = 7  # a number before a drop that need not be found, or before a ramp goes out of sight


ON_DROP = (Verdict.FOUND, Verdict.EARLY, Verdict.LATE, Verdict.MISSED)
WRONG = (Verdict.FALSE, Verdict.EARLY, Verdict.ASTRAY)  # numbers where there is nothing


def judge(ranges: Ranges, truth: Truth) -> Verdicts:
    """The verdict on each beam: (beams,). ranges: (beams,) [m], number, +inf or NaN."""
    number = np.isfinite(ranges)
    early = number & (ranges < truth.earliest)
    no_drop = np.isposinf(truth.earliest)
    on_drop = [
        (~number, Verdict.MISSED),
        (early, Verdict.EARLY),
        (ranges > truth.edge + truth.allowed, Verdict.LATE),
        (number, Verdict.FOUND),
    ]
    return np.select(
        [*(truth.drop & chosen for chosen, _ in on_drop), no_drop & number, no_drop, early],
        [*(verdict for _, verdict in on_drop), Verdict.FALSE, Verdict.QUIET, Verdict.ASTRAY],
        default=Verdict.UNCOUNTED,
    ).astype(np.int8)


class Tally(NamedTuple):
    """The verdicts of one scan, or of many."""

    counts: NDArray[np.int64]  # (verdicts,) beams
    errors: Ranges  # [m] of the numbers on drop beams: reported less true distance
    relative: Ranges  # the same over the allowed error
    hidden: int = 0  # beams that report a number where a ramp is out of sight, of those that saw little of it,
    sinking: int = 0  # and of those that saw more
    telling: int = 0  # drop beams that tell how far floor was seen,
    beyond: int = 0  # and of those that tell it too far

    @classmethod
    def of(cls, beams: Beams, truth: Truth) -> Self:
        """The tally of one scan."""
        ranges = beams.ranges
        verdicts = judge(ranges, truth)
        counts = np.bincount(verdicts, minlength=len(Verdict))
        reporting = truth.drop & np.isfinite(ranges)
        errors = ranges[reporting] - truth.edge[reporting]
        undecided = truth.undecidable & np.isfinite(ranges) & (verdicts == Verdict.UNCOUNTED)
        sinking = int((undecided & truth.sinking).sum())
        hidden = int(undecided.sum()) - sinking
        told = truth.drop & bool(len(beams.clear))
        beyond = int((beams.clear > truth.edge + truth.allowed)[told].sum()) if told.any() else 0
        return cls(counts, errors, errors / truth.allowed[reporting], hidden, sinking, int(told.sum()), beyond)

    @classmethod
    def total(cls, tallies: Sequence[Self]) -> Self:
        """All of them together."""
        none = np.zeros(0)
        return cls(
            np.sum([np.zeros(len(Verdict), np.int64), *(tally.counts for tally in tallies)], axis=0),
            np.concatenate([none, *(tally.errors for tally in tallies)]),
            np.concatenate([none, *(tally.relative for tally in tallies)]),
            sum(tally.hidden for tally in tallies),
            sum(tally.sinking for tally in tallies),
            sum(tally.telling for tally in tallies),
            sum(tally.beyond for tally in tallies),
        )

    def count(self, *verdicts: Verdict) -> int:
        """How many beams got one of these verdicts."""
        return int(sum(self.counts[verdict] for verdict in verdicts))

    def share(self, chosen: Sequence[Verdict], among: Sequence[Verdict]) -> float:
        """Beams with the chosen verdicts among those with any of the others; NaN where there are none."""
        return ratio(self.count(*chosen), self.count(*among))


def ratio(part: float, whole: float) -> float:
    """The share that part is of the whole; NaN of nothing."""
    return part / whole if whole else math.nan


def percentile(values: Ranges, percent: float) -> float:
    """NaN where there are no values."""
    return float(np.percentile(values, percent)) if len(values) else math.nan
