"""One scan of several: positive and negative of a frame, and the extra inputs."""

import math
from collections.abc import Mapping

import numpy as np

from cliffscan.common.contract.beam_fields import Beams, Ranges
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.perception.combine import beams_with, combine, within
from cliffscan.services.fuse.config import ExtraInput
from cliffscan.services.fuse.pairing import Pair
from cliffscan.services.fuse.resample import resample


class GridMismatch(ValueError):
    """Two scans of one frame have different beams; the text says which."""


def fuse(pair: Pair, extras: Mapping[str, tuple[ExtraInput, LaserScan]]) -> LaserScan:
    """The nearest of all inputs, beam by beam, on the grid of the pair. Paper: algorithm 3.

    An extra input can add obstacles; it neither frees a beam that the camera did not see nor closes one that it does
    not see itself. Raises GridMismatch.

    With extra inputs range_min is 0, for seen from the camera their obstacles may be at any distance. It never changes,
    as nothing is fused without each input that is configured.
    """
    positive, negative = pair
    grid = positive.grid()
    if not grid.matches(negative.grid()):
        raise GridMismatch(f"positive has {grid}, negative has {negative.grid()}")
    range_max = min(positive.range_max, negative.range_max)
    inputs: list[Beams] = [_beams(positive, Evidence.POSITIVE), _beams(negative, Evidence.DROP)]
    inputs += [beams_with(_resampled(source, scan, grid), Evidence.EXTRA) for source, scan in extras.values()]
    fused = combine([within(each, range_max) for each in inputs])
    return positive.model_copy(
        update={
            "range_min": 0.0 if extras else min(positive.range_min, negative.range_min),
            "range_max": range_max,
            **fused.arrays(),
        }
    )


def _beams(scan: LaserScan, otherwise: Evidence) -> Beams:
    """The beams of a scan; one that came without evidence is taken for what its key says."""
    if len(scan.intensities):
        return scan
    return scan.model_copy(update={"intensities": beams_with(scan.ranges, otherwise).intensities})


def _resampled(source: ExtraInput, scan: LaserScan, grid: Grid) -> Ranges:
    valid = (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max) & (scan.ranges > 0.0)  # 0: no return
    ranges = np.where(valid, scan.ranges, np.float32(np.nan))
    return resample(
        ranges, scan.grid().angles(), scan.angle_increment, (source.x, source.y, math.radians(source.yaw)), grid
    )
