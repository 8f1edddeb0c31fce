"""Algorithm 3: of several scans, beam by beam, the nearest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cliffscan.common.contract.beam_fields import ABSENT, BEAM_FIELDS, Beams, Combining, Ranges

OF_NEAREST = [name for name, row in BEAM_FIELDS.items() if row.combining is Combining.OF_NEAREST]
LEAST = [name for name, row in BEAM_FIELDS.items() if row.combining is Combining.LEAST]
NOTHING = np.float32(0.0)


def beams_with(ranges: Ranges, evidence: float) -> Beams:
    """Beams whose numbers all rest on the same evidence; where there is no number there is none."""
    return Beams(ranges=ranges, intensities=np.where(np.isfinite(ranges), np.float32(evidence), NOTHING))


def within(beams: Beams, range_max: float) -> Beams:
    """The same beams where numbers beyond range_max [m] are +inf: nothing was found up to there."""
    beyond, limit = beams.ranges > range_max, np.float32(range_max)
    fields = {"ranges": np.where(beyond, np.float32(np.inf), beams.ranges)}
    for name in OF_NEAREST:
        values = getattr(beams, name)
        fields[name] = np.where(beyond, NOTHING, values) if len(values) else ABSENT
    return Beams(**fields, **{name: np.minimum(getattr(beams, name), limit) for name in LEAST})


def combine(scans: Sequence[Beams]) -> Beams:
    """The nearest number of each beam, with what belongs to it; of equal ones the first. Paper: algorithm 3.

    Where there is no number, a beam is free (+inf) only if every scan looked; one that did not see makes it NaN:
    what one method does not know, another's silence does not make free. Further fields combine as BEAM_FIELDS says; one
    that no scan has is absent.
    """
    ranges, unseen = scans[0].ranges, np.isnan(scans[0].ranges)
    fields = {name: _values(scans[0], name) for name in OF_NEAREST if _any_has(scans, name)}
    for scan in scans[1:]:
        nearer = (scan.ranges < ranges) | (np.isnan(ranges) & ~np.isnan(scan.ranges))
        ranges = np.where(nearer, scan.ranges, ranges)
        fields = {name: np.where(nearer, _values(scan, name), values) for name, values in fields.items()}
        unseen |= np.isnan(scan.ranges)
    unseen &= ~np.isfinite(ranges)
    fields = {name: np.where(unseen, NOTHING, values) for name, values in fields.items()}
    for name in LEAST:
        if _any_has(scans, name):
            fields[name] = np.minimum.reduce([scan.up_to(name) for scan in scans])
    return Beams(**{"intensities": ABSENT, **fields, "ranges": np.where(unseen, np.float32(np.nan), ranges)})


def _any_has(scans: Sequence[Beams], name: str) -> bool:
    return any(len(getattr(scan, name)) for scan in scans)


def _values(scan: Beams, name: str) -> Ranges:
    """A field's values, 0 where it is absent."""
    values: Ranges = getattr(scan, name)
    return values if len(values) else np.zeros(len(scan.ranges), np.float32)
