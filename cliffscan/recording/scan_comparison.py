"""Two scans of one frame, compared beam by beam."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.messages import LaserScan

Mask = NDArray[np.bool_]


class Difference(NamedTuple):
    """What differs in each beam, `then` in a recording and `now`: (beams,) each."""

    equal: Mask  # all fields are, bit by bit
    moved: Mask  # both have a number, and it is another
    appeared: Mask  # a number where there was none
    vanished: Mask  # none where there was a number
    freed: Mask  # +inf where there was NaN, or NaN where there was +inf
    evidence: Mask  # the number rests on something else
    shorter: Mask  # less floor is clear
    longer: Mask  # more floor is clear
    by: Ranges  # [m] by which the number moved, 0 without two

    @property
    def any(self) -> Mask:
        """Whether a beam differs by more than is tolerated."""
        return self.moved | self.appeared | self.vanished | self.freed | self.evidence | self.shorter | self.longer


def compare(then: LaserScan, now: LaserScan, tolerance: float) -> Difference:
    """What differs between two scans of one grid; numbers and clear floor by more than `tolerance` [m]."""
    hit_then, hit_now = np.isfinite(then.ranges), np.isfinite(now.ranges)
    both = hit_then & hit_now
    by = np.zeros(len(both), np.float32)
    np.subtract(now.ranges, then.ranges, out=by, where=both)
    clear_then, clear_now = then.up_to("clear"), now.up_to("clear")
    with np.errstate(invalid="ignore"):  # inf less inf
        grown = np.where(clear_now == clear_then, np.float32(0.0), clear_now - clear_then)
    return Difference(
        equal=_same_bits(then, now),
        moved=np.abs(by) > tolerance,
        appeared=hit_now & ~hit_then,
        vanished=hit_then & ~hit_now,
        freed=~hit_then & ~hit_now & (np.isinf(then.ranges) != np.isinf(now.ranges)),
        evidence=both & (_evidence(then) != _evidence(now)),
        shorter=grown < -tolerance,
        longer=grown > tolerance,
        by=by,
    )


def _same_bits(then: LaserScan, now: LaserScan) -> Mask:
    """Whether all fields of a beam are the same; an absent one is unlike any number."""
    same = np.ones(len(then.ranges), np.bool_)
    new = now.arrays()
    for name, old in then.arrays().items():
        if len(old) != len(new[name]):
            return np.zeros_like(same)
        if len(old):
            same &= old.view(np.uint32) == new[name].view(np.uint32)
    return same


def _evidence(scan: LaserScan) -> Ranges:
    return scan.intensities if len(scan.intensities) else np.zeros_like(scan.ranges)


class Tally:
    """The differences of all scans of one key, and the scan that differs most."""

    HEADINGS = (
        "scan", "scans", "beams", "equal", "moved", "by at most", "appeared", "vanished", "freed", "evidence",
        "clear shorter", "clear longer",
    )  # fmt: skip

    def __init__(self) -> None:
        self.scans = 0
        self.worst = 0.0  # share of a scan's beams that differ
        self._beams = 0
        self._most = 0.0
        self._counts = dict.fromkeys(Difference._fields[:-1], 0)

    def add(self, difference: Difference) -> float:
        """Count one scan; the share of its beams that differ."""
        self.scans += 1
        self._beams += len(difference.by)
        self._most = max(self._most, float(np.abs(difference.by).max()))
        for name in self._counts:
            self._counts[name] += int(getattr(difference, name).sum())
        share = float(difference.any.mean())
        self.worst = max(self.worst, share)
        return share

    def row(self, path: str) -> Iterable[str]:
        """The cells below HEADINGS."""
        equal, moved, *others = self._counts.values()
        share = f"{100.0 * equal / self._beams:.2f} %" if self._beams else "-"
        return (path, str(self.scans), str(self._beams), share, str(moved), f"{self._most:.3f} m", *map(str, others))
