"""Algorithm 3: of several scans, beam by beam, the nearest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Ranges = NDArray[np.float32]
NOT_TOLD = np.empty(0, np.float32)


class Beams(NamedTuple):
    """What a scan tells, beam by beam: (beams,) each."""

    ranges: Ranges  # [m] number, +inf (looked, nothing) or NaN (not seen)
    evidence: Ranges  # Evidence
    clear: Ranges = NOT_TOLD  # [m] up to which floor was seen throughout; or (0,)

    @classmethod
    def of(cls, ranges: Ranges, evidence: float) -> Beams:
        """All numbers rest on the same evidence; where there is no number there is none."""
        return cls(ranges, np.where(np.isfinite(ranges), np.float32(evidence), np.float32(0.0)))

    def within(self, range_max: float) -> Beams:
        """The same where numbers beyond range_max [m] are +inf: nothing was found up to there."""
        beyond = self.ranges > range_max
        return Beams(
            np.where(beyond, np.float32(np.inf), self.ranges),
            np.where(beyond, np.float32(0.0), self.evidence),
            np.minimum(self.clear, np.float32(range_max)),
        )


def combine(scans: Sequence[Beams]) -> Beams:
    """The nearest number of each beam, with its evidence; of equal ones the first. Paper: algorithm 3.

    Where there is no number, a beam is free (+inf) only if every scan looked; one that did not see makes it NaN:
    what one method does not know, another's silence does not make free. If any scan tells how far floor is seen, so
    does the combination: as far as all of them allow.
    """
    ranges, evidence, _ = scans[0]
    unseen = np.isnan(ranges)
    for scan in scans[1:]:
        nearer = (scan.ranges < ranges) | (np.isnan(ranges) & ~np.isnan(scan.ranges))
        ranges, evidence = np.where(nearer, scan.ranges, ranges), np.where(nearer, scan.evidence, evidence)
        unseen |= np.isnan(scan.ranges)
    unseen &= ~np.isfinite(ranges)
    ranges, evidence = np.where(unseen, np.float32(np.nan), ranges), np.where(unseen, np.float32(0.0), evidence)
    return Beams(ranges, evidence, _clear(scans))


def _clear(scans: Sequence[Beams]) -> Ranges:
    """As far as every scan allows [m]: what it says, or one that says nothing, up to its number; NaN allows nothing."""
    if not any(len(scan.clear) for scan in scans):
        return NOT_TOLD
    clear: Ranges = np.minimum.reduce([taken_at_its_word(scan.ranges, scan.clear) for scan in scans])
    return clear


def taken_at_its_word(ranges: Ranges, clear: Ranges) -> Ranges:
    """How far floor was seen [m]; a scan that does not tell means up to its number, and NaN nowhere."""
    return clear if len(clear) else np.fmax(ranges, np.float32(0.0))
