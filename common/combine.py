"""Algorithm 3: of several scans, beam by beam, the nearest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Ranges = NDArray[np.float32]


class Beams(NamedTuple):
    """What a scan tells, beam by beam. ranges [m]: number, +inf (looked, nothing) or NaN (not seen); evidence."""

    ranges: Ranges
    evidence: Ranges

    @classmethod
    def of(cls, ranges: Ranges, evidence: float) -> Beams:
        """All numbers rest on the same evidence; where there is no number there is none."""
        return cls(ranges, np.where(np.isfinite(ranges), np.float32(evidence), np.float32(0.0)))

    def within(self, range_max: float) -> Beams:
        """The same where numbers beyond range_max [m] are +inf: nothing was found up to there."""
        beyond = self.ranges > range_max
        return Beams(
            np.where(beyond, np.float32(np.inf), self.ranges), np.where(beyond, np.float32(0.0), self.evidence)
        )


def combine(scans: Sequence[Beams]) -> Beams:
    """The nearest number of each beam, with its evidence; of equal ones the first. Paper: algorithm 3.

    Where there is no number, a beam is free (+inf) only if every scan looked; one that did not see makes it NaN:
    what one method does not know, another's silence does not make free.
    """
    ranges = np.stack([scan.ranges for scan in scans])
    evidence = np.stack([scan.evidence for scan in scans])
    nearest = np.where(np.isnan(ranges), np.inf, ranges).argmin(axis=0)[None]
    chosen = np.take_along_axis(ranges, nearest, axis=0)[0]
    unseen = np.isnan(ranges).any(axis=0) & ~np.isfinite(chosen)
    return Beams(
        np.where(unseen, np.float32(np.nan), chosen),
        np.where(unseen, np.float32(0.0), np.take_along_axis(evidence, nearest, axis=0)[0]),
    )
