"""What the beams of a scan report about the ground, as REP-117 has it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from examples.slam.wire import Scan


@dataclass(frozen=True)
class Beams:
    """Each beam: its direction, how far it reports the ground to be free, and where something is."""

    angles: NDArray[np.float64]  # (beams,) [rad]
    free: NDArray[np.float64]  # (beams,) [m]; 0 where it reports nothing
    ends: NDArray[np.float64]  # (beams,) [m] to an obstacle or an edge; NaN where there is none

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Which beams (beams,) end at an obstacle or an edge."""
        return np.isfinite(self.ends)


def beams(scan: Scan, reach: float) -> Beams:
    """What a scan reports up to `reach` [m].

    A number is free ground up to an obstacle, or to an edge: a map shows a staircase as it shows a wall. A number
    without evidence is free ground only; what lies beyond `reach` is free up to there, and so is +inf. NaN was not
    seen: it reports nothing, nor does a number outside the scan's own limits. But a scan that reports how far it saw
    floor is believed in each beam: that is free, and no more.
    """
    ranges = scan.ranges.astype(np.float64)
    number = (ranges >= scan.range_min) & (ranges <= scan.range_max)
    evident = scan.evidence > 0 if len(scan.evidence) else True
    farthest = min(reach, scan.range_max)
    free = np.fmin(scan.clear, ranges) if len(scan.clear) else np.where(number | np.isposinf(ranges), ranges, 0.0)
    ends = np.where(number & (ranges <= farthest) & evident, ranges, np.nan)
    return Beams(scan.angles, np.clip(free, 0.0, farthest), ends)
