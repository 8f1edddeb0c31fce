"""Near edge: the floor is followed outward from the robot, and ends where the last of it was seen.

Each beam's line in the image is followed over the floor; where the floor stops, by a drop or by data lost over more
than the sensor's row spacing and noise explain, the last floor seen is the edge.
"""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Camera, Floats, scan_axes
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.floor_points import FloorPoints, Metres
from cliffscan.common.perception.image_region import ImageRegion
from cliffscan.common.perception.low_steps import Sight
from cliffscan.common.perception.scans import ImageScanConfig
from cliffscan.services.negative.beam_lines import (
    BeamLines,
    Rows,
    beam_lines,
    heights_along,
    lines_per_beam,
    rows_outward,
)
from cliffscan.services.negative.border_lines import end_at_border
from cliffscan.services.negative.faces import end_at_faces
from cliffscan.services.negative.floor_following import End, FloorCriteria, floor_trace, single
from cliffscan.services.negative.line_edges import locate_edges, reject_unreliable
from cliffscan.services.negative.lost_floor import beyond_lost_floor, far_off
from cliffscan.services.negative.ramps import ramps_ahead, resolves_ramps
from cliffscan.services.negative.registry import negative_method
from cliffscan.services.negative.shadow import Pixels, shadowed
from cliffscan.services.negative.step_ends import end_at_steps

TRUSTED = 0.97  # of the sensor's range; beyond, noise takes depths out of it
Meanings = NDArray[np.int8]  # Ends
FloorLost = Literal["counts", "beside_drop", "ignored"]


class NearEdgeConfig(ImageScanConfig):
    """What near_edge takes for floor."""

    floor_lost: FloorLost = "counts"
    """What floor without data is: it counts as a drop, counts only beside_drop that is seen, or is ignored."""
    least_drop: Annotated[float, Field(ge=0.01, le=0.2)] = 0.025
    """Height [m] of the lowest step down that is a drop wherever floor is followed; wheel_step is for lower ones."""
    least_gap: Annotated[float, Field(ge=0.02, le=1)] = 0.12
    """Length [m] of floor without data from which on it is lost; less is chance."""
    sight: Annotated[float, Field(gt=0, le=20)] = 4.0
    """Distance [m] up to which the sensor sees floor, if its range allows."""
    grazing: Annotated[float, Field(ge=0.01, le=0.5)] = 0.07
    """Sine [1] of the angle below which floor may return nothing."""

    def criteria(self, camera: Camera) -> FloorCriteria[float]:
        """What near_edge takes for floor in images of a camera."""
        near, far = camera.range
        slope = self.steepest_rise()
        return FloorCriteria(
            near, min(TRUSTED * far, self.sight), camera.noise, self.grazing, slope, self.least_drop, self.least_gap
        )


@negative_method("near_edge", NearEdgeConfig)
def find(points: FloorPoints, config: NearEdgeConfig) -> Beams:
    """The method with its configuration."""
    return near_edge(points, config.grid(), config.criteria(points.region.camera), config.floor_lost, config.wheel_step)


def near_edge(
    points: FloorPoints,
    grid: Grid,
    criteria: FloorCriteria[float],
    floor_lost: FloorLost,
    wheel_step: float = 0.0,
) -> Beams:
    """Range [m] of the last floor before a drop in each beam, on what it rests, how far floor is clear: (beams,) each.

    +inf where floor was seen as far as the sensor sees it; NaN where it was not: behind an obstacle, in its shadow,
    beyond a gap. An edge can be told no better than the spacing of the rows on the floor, z²/(f·h).
    floor_lost: whether floor that is lost counts as a drop, only beside a drop that is seen, or not at all; wheel_step
    [m]: what the wheels take of a step, 0 = low steps are not looked for.
    """
    region, height = points.region, points.region.camera.floor.d
    each = lines_per_beam(region, grid)
    lines = beam_lines(region, grid, each)
    order = rows_outward(region, lines, criteria.far)
    if not len(order):
        nothing = np.zeros(grid.beams, np.float32)
        return Beams(ranges=np.full(grid.beams, np.nan, np.float32), intensities=nothing, clear=nothing)
    heights, in_view = heights_along(points, lines, order)
    traced = floor_trace(heights, order, lines, in_view, np.float32(height), single(criteria))
    if wheel_step:
        end_at_steps(traced, heights, order, lines, Sight.of(region, wheel_step, criteria.slope))
    end, row, level, *_ = traced
    facts = height, criteria.noise
    end_at_faces(heights, order, lines, in_view.first, *traced, *facts, criteria.slope, criteria.step)
    lost = np.flatnonzero(end == End.NO_RETURN)
    far = far_off(lines, row, level, in_view.due, height)
    seen_last = row[lost], level[lost], far[lost]
    seen_beyond = beyond_lost_floor(heights, order, lines, lost, *seen_last, *facts, criteria.step, criteria.gap)
    shows, hidden, goes_on = seen_beyond
    end[lost[goes_on]], end[lost[hidden]] = End.UNVERIFIED, End.OCCLUDED
    far[lost[~shows]] = False
    lost = lost[end[lost] == End.NO_RETURN]
    # this and what follows without a look whether there are any, so that a blank frame compiles it
    end[lost[in_shadow(points, lines, lost, row[lost], order)]] = End.OCCLUDED
    if resolves_ramps(region.camera):
        ended = np.flatnonzero((end == End.DROP) | (end == End.NO_RETURN))
        limits = region.camera.range[1], criteria.noise, criteria.slope, criteria.grazing
        ramps = ramps_ahead(heights, order, lines, ended, row[ended], height, *limits)
        end[ended[ramps]] = End.UNVERIFIED  # its rows lie too far apart to call it free
    ranges, clear = locate_edges(*traced, lines, height)
    end_at_border(end, clear, lines, in_view.first, order, region.shape[1], height)
    spacing = grid.increment / each
    reject_unreliable(end, ranges, in_view.first, far, spacing, floor_lost == "counts", floor_lost != "ignored")
    ranges = np.maximum(ranges, points.range_min)  # as near as a scan reports
    return beams_of_lines(end.astype(np.int8), ranges, clear, each)


def in_shadow(points: FloorPoints, lines: BeamLines, lost: Pixels, row: Metres, order: Rows) -> Pixels:
    """Those of the lines `lost` whose floor, last seen in these rows, is hidden beyond by something beside."""
    region, camera = points.region, points.region.camera
    outward = 1 if order[-1] > order[0] else -1
    last, beyond = (pixels(region, lines, lost, rows) for rows in (row, row + 2 * outward))
    _, _, up = scan_axes(camera)
    disparity = camera.baseline * camera.intrinsics.fx
    near, far = points.usable
    hidden = shadowed(points.depth, int(near), int(far), up, camera.floor.d, last, beyond, disparity)
    return np.flatnonzero(hidden)


def pixels(region: ImageRegion, lines: BeamLines, some: Pixels, rows: Metres) -> Pixels:
    """Row and column in the whole image at which some lines pass rows of a region: (n, 2)."""
    columns = np.floor(lines.column[some] + rows * lines.column_step[some] + np.float32(0.5))
    columns = np.clip(columns, 0, region.shape[1] - 1)
    down, right = (columns, rows) if region.transposed else (rows, columns)
    return np.stack([down + region.rows.start, right + region.columns.start], axis=1).astype(np.int64)


def beams_of_lines(end: Meanings, ranges: Floats, clear: Floats, each: int) -> Beams:
    """What the beams say, of `each` lines: the worst of them, which is the nearest number, or NaN, or +inf."""
    said = np.where(EVIDENCE[end] > 0.0, ranges, WITHOUT_NUMBER[end])
    badness = np.where(np.isnan(said), BETWEEN, said).reshape(-1, each)
    worst = np.argmin(badness, axis=1) + np.arange(0, len(said), each)
    return Beams(
        ranges=said[worst].astype(np.float32),
        intensities=EVIDENCE[end][worst].astype(np.float32),
        clear=clear.reshape(-1, each).min(axis=1).astype(np.float32),
    )


BETWEEN = 1e9  # [m] beyond any number, before +inf
EVIDENCE = np.zeros(len(End))  # of each End; 0: it makes no number
EVIDENCE[End.DROP], EVIDENCE[End.NO_RETURN] = Evidence.DROP, Evidence.FLOOR_LOST
WITHOUT_NUMBER = np.full(len(End), np.nan)  # what the others make
WITHOUT_NUMBER[End.REACHED_RANGE] = np.inf
