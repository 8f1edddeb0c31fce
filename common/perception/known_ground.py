"""What of a scan is known ground, for whatever reads its ranges and nothing of `clear`.

A number says where something stands, not that there is ground before it, so a reader that takes it for the end of free
ground would free what nobody saw.
"""

import math

import numpy as np

from cliffscan.common.contract.beam_fields import Ranges
from cliffscan.common.contract.evidence import EDGES, Evidence
from cliffscan.common.contract.messages import LaserScan

CELL = 0.05  # [m] of a usual map: ground may end so much before a number, as an image's rows do
BESIDE = math.radians(1.5)  # from an edge, within which the last of a hole's corner is overlooked
SAFE_RANGE = 4.0  # [m] up to which near_edge follows the floor: beyond it no ground is known
NAN, INF = np.float32(np.nan), np.float32(np.inf)


def known_ground(scan: LaserScan) -> Ranges:
    """How far [m] ground is known in each beam: (beams,).

    That is `clear`, but no farther than an edge less than BESIDE away, unless the beam ends at an edge of its own:
    near_edge needs some 15 cm of hole along a beam, so between an edge and a wall it overlooks the tip. What is beside
    the first and the last beam nobody saw. A scan without `clear` is taken at its word.
    """
    clear = scan.up_to("clear")
    width = int(BESIDE / scan.angle_increment)
    if not len(scan.clear) or not width:
        return clear
    edge = np.zeros(len(clear), bool)
    if len(scan.intensities):
        for evidence in map(float, EDGES):  # numpy compares with an enumeration five times as slowly
            edge |= scan.intensities == evidence
    unseen = np.zeros(width, np.float32)
    edges = np.concatenate([unseen, np.where(edge, scan.ranges, INF), unseen])
    return np.where(edge, clear, np.minimum(clear, least_of(edges, 2 * width + 1)))


def least_of(values: Ranges, count: int) -> Ranges:
    """The least of each `count` values in a row: (n - count + 1,) of (n,). Of each 2, 4, 8 … by turns."""
    span = 1
    while 2 * span <= count:
        values = np.minimum(values[:-span], values[span:])
        span *= 2
    rest = count - span
    return np.minimum(values[: len(values) - rest], values[rest:])


def safe_ranges(scan: LaserScan, known: Ranges, farthest: float, beyond: float = math.inf) -> Ranges:
    """The numbers before which ground is known but for a CELL, `beyond` where it is up to `farthest` [m], else NaN.

    known: (beams,) [m], of known_ground. No number is beyond `farthest`.
    """
    ends = np.fmin(scan.ranges, np.float32(farthest))
    numbers = np.where(ends < np.float32(farthest), ends, np.float32(beyond))
    return np.where(known >= ends - np.float32(CELL), numbers, NAN)


def safe_scan(scan: LaserScan) -> LaserScan:
    """The scan whose ranges are safe to be read alone."""
    farthest = min(scan.range_max, SAFE_RANGE)
    known = known_ground(scan)
    ranges = safe_ranges(scan, known, farthest)
    fields = {"ranges": ranges, "clear": np.minimum(known, np.float32(farthest))}
    if len(scan.intensities):
        fields["intensities"] = np.where(np.isfinite(ranges), scan.intensities, np.float32(Evidence.NOTHING))
    return scan.model_copy(update={"range_max": farthest, "range_min": min(scan.range_min, farthest), **fields})
