"""Near edge: the floor is followed outward from the robot, and ends where the last of it was seen.

Each column of the image is followed over the floor; where the floor stops, by a drop or by data lost over more than the
sensor's row spacing and noise explain, the last floor seen is the edge.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.image_region import ImageRegion
from cliffscan.common.perception.point_heights import PointHeights
from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.services.negative.column_beams import beams_of_columns
from cliffscan.services.negative.column_edges import locate_edges, reject_unreliable
from cliffscan.services.negative.floor_following import End, FloorCriteria, floor_trace, single
from cliffscan.services.negative.registry import negative_method
from cliffscan.services.negative.shadow import shadowed

TRUSTED = 0.97  # of the sensor's range; beyond, noise takes depths out of it
FloorLost = Literal["counts", "beside_drop", "ignored"]

APART = 0.01  # [m] of floor between two rows that are looked at, where the image has more


class NearEdgeConfig(ImageScanConfig):
    """What near_edge takes for floor."""

    floor_lost: FloorLost = "counts"
    """What floor without data is: it counts as a drop, counts only beside_drop that is seen, or is ignored."""
    least_drop: Annotated[float, Field(ge=0.01, le=0.2)] = 0.025
    """Height [m] of the lowest step down that is a drop; a lower one is floor."""
    least_gap: Annotated[float, Field(ge=0.02, le=1)] = 0.12
    """Length [m] of floor without data from which on it is lost; less is chance."""
    sight: Annotated[float, Field(gt=0, le=20)] = 4.0
    """Distance [m] up to which the sensor sees floor, if its range allows."""
    grazing: Annotated[float, Field(ge=0.01, le=0.5)] = 0.07
    """Sine [1] of the angle below which floor may return nothing."""
    noise: Annotated[float, Field(ge=1e-4, le=0.1)] = 1.64e-3
    """Standard deviation [1/m] of the inverse depth, the sensor's steps included."""
    baseline: Annotated[float, Field(ge=0, le=1)] = 0.075
    """Distance [m] between camera and projector, which makes shadows as wide."""

    def criteria(self, camera: Camera) -> FloorCriteria[float]:
        """What near_edge takes for floor in images of a camera."""
        near, far = camera.range
        slope = self.steepest_rise()
        return FloorCriteria(
            near, min(TRUSTED * far, self.sight), self.noise, self.grazing, slope, self.least_drop, self.least_gap
        )


@negative_method("near_edge", NearEdgeConfig)
def find(points: PointHeights, config: NearEdgeConfig) -> Beams:
    """The method with its configuration."""
    criteria = config.criteria(points.region.camera)
    return near_edge(points, config.grid(), criteria, config.floor_lost, config.baseline)


def near_edge(
    points: PointHeights, grid: Grid, criteria: FloorCriteria[float], floor_lost: FloorLost, baseline: float
) -> Beams:
    """Range [m] of the last floor before a drop in each beam, on what it rests, how far floor is clear: (beams,) each.

    +inf where floor was seen as far as the sensor sees it; NaN where it was not: behind an obstacle, in its shadow,
    beyond a gap. An edge can be told no better than the spacing of the rows on the floor, z²/(f·h).
    floor_lost: whether floor that is lost counts as a drop, only beside a drop that is seen, or not at all;
    baseline [m]: between the sensor's two eyes, or its eye and its projector.
    """
    region = points.region
    rates = region.up.single(-1.0)
    height = np.float32(region.camera.floor.d)
    order = rows_outward(region, criteria)
    if not len(order):
        nothing = np.zeros(grid.beams, np.float32)
        return Beams(ranges=np.full(grid.beams, np.nan, np.float32), intensities=nothing, clear=nothing)
    end, row, level, sure, sure_level = floor_trace(points.heights, order, rates, height, single(criteria))
    if not region.transposed:  # a camera on its side has its eyes one above the other
        lost = np.flatnonzero(end == End.NO_RETURN)
        outward = 1 if region.up.rows[1] > region.up.rows[0] else -1
        disparity = baseline * region.camera.intrinsics.fx
        rows = row[lost].astype(np.int64)
        hidden = shadowed(points.heights, rates, height, lost, rows, outward, disparity, criteria.near)
        end[lost[hidden]] = End.OCCLUDED
    azimuths, widths, ranges, clear, doubted = locate_edges(
        end, row, level, sure, sure_level, region.forward, region.left, region.up, region.camera.floor.d
    )
    reject_unreliable(end, ranges, widths, floor_lost == "counts", floor_lost != "ignored")
    meaning = end.astype(np.int8)
    ranges = np.where(EVIDENCE[meaning] > 0.0, ranges, WITHOUT_NUMBER[meaning])
    return beams_of_columns(azimuths, widths, ranges, EVIDENCE[meaning], clear, doubted, grid)


EVIDENCE = np.zeros(len(End))  # of each End; 0: it makes no number
EVIDENCE[End.DROP], EVIDENCE[End.NO_RETURN] = Evidence.DROP, Evidence.FLOOR_LOST
WITHOUT_NUMBER = np.full(len(End), np.nan)  # what the others make
WITHOUT_NUMBER[End.REACHED_RANGE] = np.inf


@lru_cache(maxsize=4)
def rows_outward(region: ImageRegion, criteria: FloorCriteria[float]) -> NDArray[np.int32]:
    """The rows of a region that see floor in range, near to far, each at least APART beyond the one before."""
    rows = np.arange(region.shape[0])
    if region.up.rows[0] > region.up.rows[1]:
        rows = rows[::-1]
    rate = -(region.up.rows[rows, None] + region.up.columns[None, [0, len(region.up.columns) // 2, -1]])
    inverse = rate / region.camera.floor.d
    floor = np.any((inverse > 0.5 / criteria.far) & (rate > 0.0), axis=1)
    steps = np.floor(1.0 / (APART * np.maximum(inverse, 0.5 / criteria.far)))
    moved = np.any(np.diff(steps, axis=0, prepend=-1.0) != 0.0, axis=1)
    chosen: NDArray[np.int32] = rows[floor & moved].astype(np.int32)
    return chosen
