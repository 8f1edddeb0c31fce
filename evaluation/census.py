"""What scans report where nobody knows the truth, as on recorded frames: shares and tables."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.beam_fields import Ranges
from evaluation.score import percentile
from evaluation.tables import Table, number, percent

HEADINGS = ("scan", "number", "free (inf)", "not seen (NaN)", "median [m]")
NOTE = """\
Shares of all beams: those with a number, those that looked and found nothing,
those that did not see. The median is that of the numbers.
"""


class Census(NamedTuple):
    """What scans report, where the truth is not known."""

    number: float  # share of all beams
    free: float  # share of all beams: +inf
    unseen: float  # share of all beams: NaN
    median: float  # [m] of the numbers; NaN where there are none


def census(ranges: Ranges) -> Census:
    """What scans (frames, beams) [m] report."""
    numbers = np.isfinite(ranges)
    free, unseen = (float(chosen.mean()) for chosen in (np.isposinf(ranges), np.isnan(ranges)))
    return Census(float(numbers.mean()), free, unseen, percentile(ranges[numbers], 50))


def census_table(title: str, counts: Mapping[str, Census]) -> Table:
    """What each scan reports."""
    rows = [(scan, *map(percent, each[:3]), number(each.median, ".3f")) for scan, each in counts.items()]
    return Table(title, HEADINGS, rows, 1, NOTE)
