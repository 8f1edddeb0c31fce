"""How well scans find where the floor ends: functions of ranges and the truth, and nothing else."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]

TOLERANCE = 0.10  # [m] by which a number may be too far or too near

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
"""


class Truth(NamedTuple):
    """What is truly there, beam by beam: three of (beams,)."""

    edge: Floats  # [m] where the floor ends by a drop; inf = nowhere
    reachable: NDArray[np.bool_]  # the sensor could measure a point at that edge
    obstacle: Floats  # [m] nearest obstacle in the way of the robot's body; inf = none


class Score(NamedTuple):
    """The measures of DEFINITIONS; NaN where there is no beam to take them over."""

    median: float  # [m]
    percentile95: float  # [m]
    missed: float  # share of the beams with an edge
    late: float  # share of the beams with an edge
    false: float  # share of all beams


def score(ranges: Floats, truth: Truth) -> Score:
    """The score of scans (frames, beams) [m] of one view, numbers, +inf (free) or NaN (not seen), by DEFINITIONS."""
    has_edge = np.isfinite(truth.edge) & truth.reachable
    reported = np.isfinite(ranges)
    at_edge = ranges[:, has_edge]
    error = at_edge - truth.edge[has_edge]
    numbers = error[reported[:, has_edge]]
    first = np.minimum(truth.edge, truth.obstacle)
    return Score(
        median=_percentile(numbers, 50),
        percentile95=_percentile(numbers, 95),
        missed=_share(~reported[:, has_edge]),
        late=_share(np.isfinite(at_edge) & (error > TOLERANCE)),
        false=_share(reported & (ranges < first - TOLERANCE)),
    )


def _percentile(values: Floats, percent: float) -> float:
    return float(np.percentile(values, percent)) if values.size else float("nan")


def _share(chosen: NDArray[np.bool_]) -> float:
    return float(chosen.mean()) if chosen.size else float("nan")


class Census(NamedTuple):
    """What scans report, where the truth is not known."""

    number: float  # share of all beams
    free: float  # share of all beams: +inf
    unseen: float  # share of all beams: NaN
    median: float  # [m] of the numbers; NaN where there are none


def census(ranges: Floats) -> Census:
    """What scans (frames, beams) [m] report."""
    return Census(
        number=_share(np.isfinite(ranges)),
        free=_share(np.isposinf(ranges)),
        unseen=_share(np.isnan(ranges)),
        median=_percentile(ranges[np.isfinite(ranges)], 50),
    )
