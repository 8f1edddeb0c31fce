"""The algorithms, written down as slowly and plainly as they are described: what the fast code answers to.

Of the paper's, points are taken one by one; where it has a level camera and y' = 0.3 m, the floor plane is any.
"""

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Camera
from cliffscan.common.perception.floor_points import FloorPoints
from cliffscan.common.perception.image_region import ImageRegion
from cliffscan.services.negative.beam_lines import APART, BeamLines, beam_lines, heights_along, lines_per_beam
from cliffscan.services.negative.floor_following import End, FloorCriteria
from cliffscan.services.negative.line_edges import AGREE, NARROWEST, NARROWEST_FAR, SIDE
from cliffscan.services.negative.ramps import resolves_ramps
from tests import naive_trace


def axes(camera: Camera) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forward, left and up of the scan frame, in the optical frame."""
    up = np.array(camera.floor[:3])
    forward = np.array([0.0, 0.0, 1.0])
    forward = forward - forward.dot(up) * up
    forward = forward / math.sqrt(forward.dot(forward))
    return forward, np.cross(up, forward), up


def ray(camera: Camera, row: float, column: float) -> np.ndarray:
    fx, fy, cx, cy = camera.intrinsics
    return np.array([(column - cx) / fx, (row - cy) / fy, 1.0])


def angle_of(camera: Camera, row: float, column: float) -> float:
    """Equation (1), with the scan frame's x forward and y left."""
    forward, left, _ = axes(camera)
    direction = ray(camera, row, column)
    return math.atan2(left.dot(direction), forward.dot(direction))


@cache
def pixels_of_beams(camera: Camera, grid: Grid) -> list[tuple[int, int, int]]:
    """(row, column, beam) for all that a beam sees: the pixels within half an increment, or the one that covers it."""
    seen = []
    for row in range(camera.height):
        narrow = set(range(grid.beams))
        for column in range(camera.width):
            step = math.floor((angle_of(camera, row, column) - grid.angle_min) / grid.increment + 0.5)  # equation (2)
            if 0 <= step < grid.beams:
                narrow.discard(step)
                seen.append((row, column, step))
        bounds = [angle_of(camera, row, column - 0.5) for column in range(camera.width + 1)]
        for step in narrow:
            angle = grid.angle_min + step * grid.increment
            covering = [c for c in range(camera.width) if min(bounds[c : c + 2]) <= angle < max(bounds[c : c + 2])]
            seen += [(row, column, step) for column in covering]
    return seen


def points(depth: np.ndarray, camera: Camera, grid: Grid) -> Iterator[tuple[int, float, float, float]]:
    """(beam, x, y, height) of every measured point [m]."""
    forward, left, up = axes(camera)
    near, far = camera.range
    for row, column, beam in pixels_of_beams(camera, grid):
        z = int(depth[row, column]) / 1000
        if z > 0 and near <= z <= far:
            point = ray(camera, row, column) * z
            if forward.dot(point) > 0:
                yield beam, forward.dot(point), left.dot(point), up.dot(point) + camera.floor.d


def farthest_point(depth: np.ndarray, camera: Camera, grid: Grid, floor_band: float) -> np.ndarray:
    """Algorithm 1."""
    array_a = [math.nan] * grid.beams
    for step, x, y, height in points(depth, camera, grid):
        if abs(height) <= floor_band:
            distance = math.sqrt(x**2 + y**2)  # equation (3)
            if math.isnan(array_a[step]) or array_a[step] < distance:
                array_a[step] = distance
    return np.array(array_a)


def virtual_floor(depth: np.ndarray, camera: Camera, grid: Grid, floor_band: float) -> np.ndarray:
    """Algorithm 2. A beam that saw floor and nothing below it is free; one that saw neither is not seen."""
    array_b = [math.nan] * grid.beams
    y_prime = camera.floor.d
    for step, x, y, height in points(depth, camera, grid):
        below_camera = y_prime - height
        if height < -floor_band:
            x_prime = x * y_prime / below_camera  # equation (4)
            y_new = y * x_prime / x  # equation (5)
            distance = math.sqrt(x_prime**2 + y_new**2)
        elif height <= floor_band:
            distance = math.inf
        else:
            continue
        if math.isnan(array_b[step]) or array_b[step] > distance:
            array_b[step] = distance
    return np.array(array_b)


def combine(array_a: np.ndarray, array_b: np.ndarray) -> np.ndarray:
    """Algorithm 3. Free only where both say so."""
    array_c = list(array_a)
    for step in range(len(array_c)):
        a, b = array_a[step], array_b[step]
        if math.isnan(a):
            array_c[step] = b if math.isfinite(b) else math.nan
        elif math.isnan(b):
            array_c[step] = a if math.isfinite(a) else math.nan
        elif a > b:
            array_c[step] = b
    return np.array(array_c)


def near_edge(
    points: FloorPoints, grid: Grid, criteria: FloorCriteria, floor_lost: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ours: each beam's lines are followed over the floor, to where it ends. The beams' ranges, evidence and clear."""
    region, height = points.region, np.float32(points.region.camera.floor.d)
    each = lines_per_beam(region, grid)
    lines, many = beam_lines(region, grid, each), each * grid.beams
    order = rows_outward(region, criteria.far)
    if not order:
        return np.full(grid.beams, math.nan), np.zeros(grid.beams), np.zeros(grid.beams)
    heights, in_view = heights_along(points, lines, np.array(order, np.int32))
    view = naive_trace.View(lines, in_view)
    traced = [naive_trace.floor_trace(heights, order, view, height, criteria, line) for line in range(many)]
    ends, rows, levels, sure, sure_levels = (list(values) for values in zip(*traced, strict=True))
    tall, outlying = float(height), []
    for line in range(many):
        climbed = rows[line] >= 0 and levels[line] > np.float32(criteria.step)
        if climbed and ends[line] != End.OCCLUDED:
            foot = naive_trace.foot_of_face(heights, order, view, tall, criteria, line, int(rows[line]))
            if foot:
                ends[line], (rows[line], levels[line]) = End.OCCLUDED, foot
                if (sure[line] - foot[0]) * naive_trace.outward(order) > 0:
                    sure[line], sure_levels[line] = foot
        outlying.append(naive_trace.far_off(view, tall, line, int(rows[line]), levels[line]))
        if ends[line] == End.NO_RETURN:
            at_its_end = line, int(rows[line]), levels[line]
            shows, hidden, goes_on = naive_trace.beyond_lost(heights, order, view, tall, criteria, *at_its_end)
            outlying[-1] = outlying[-1] and shows
            ends[line] = End.OCCLUDED if hidden else End.UNVERIFIED if goes_on else End.NO_RETURN
    beyond = 2 * naive_trace.outward(order)
    for line in range(many):
        if ends[line] == End.NO_RETURN:
            pixels = [pixel(region, lines, line, row) for row in (rows[line], rows[line] + beyond)]
            if naive_trace.shadowed(region.camera, points.depth, *pixels):
                ends[line] = End.OCCLUDED
    for line in range(many):
        seen = heights, order, view, region.camera, criteria, line, int(rows[line])
        if numbered(ends[line]) and resolves_ramps(region.camera) and naive_trace.ramp_ahead(*seen):
            ends[line] = End.UNVERIFIED
    levels = [averaged(ends, rows, levels, line) for line in range(many)]
    ranges = [place(region, lines, line, rows[line], levels[line]) for line in range(many)]
    clear = [
        ranges[line] if sure[line] == rows[line] else place(region, lines, line, sure[line], float(sure_levels[line]))
        for line in range(many)
    ]
    doubt(ends, ranges, in_view.first, outlying, grid.increment / each, floor_lost)
    beams = [worst(range(beam * each, (beam + 1) * each), ends, ranges, clear) for beam in range(grid.beams)]
    told, evidence, free = zip(*beams, strict=True)
    return np.array(told), np.array(evidence), np.array(free)


def rows_outward(region: ImageRegion, far: float) -> list[int]:
    """The rows that see floor, near to far: of those that see it within a centimetre of each other, the nearest."""
    columns = [0, region.shape[1] - 1]
    rows = list(range(region.shape[0]))
    if region.up.rows[0] > region.up.rows[1]:
        rows.reverse()
    chosen, before = [], None
    for row in rows:
        inverse = [-(region.up.rows[row] + region.up.columns[column]) / region.camera.floor.d for column in columns]
        farthest = min(inverse)
        step = math.floor(1 / (APART * max(farthest, 0.5 / far)))
        if max(inverse) > 0.5 / far and (step != before or farthest < 0.5 / far):
            chosen.append(row)
        before = step
    return chosen


def pixel(region: ImageRegion, lines: BeamLines, line: int, row: float) -> tuple[int, int]:
    """Row and column of the whole image at which a line passes a row of the region."""
    column = math.floor(lines.column[line] + np.float32(row) * lines.column_step[line] + np.float32(0.5))
    column = min(max(column, 0), region.shape[1] - 1)
    down, right = (column, int(row)) if region.transposed else (int(row), column)
    return down + region.rows.start, right + region.columns.start


def numbered(end: End) -> bool:
    return end in (End.DROP, End.NO_RETURN)


def averaged(ends: list[End], rows: list[int], levels: list[np.float32], u: int) -> float:
    """A line's floor level, averaged with its neighbours' that ended likewise, if that is about the same."""
    beside = range(max(u - SIDE, 0), min(u + SIDE + 1, len(ends)))
    alike = [float(levels[k]) for k in beside if numbered(ends[k]) and rows[k] >= 0]
    if not (numbered(ends[u]) and rows[u] >= 0 and abs(sum(alike) / len(alike) - levels[u]) < AGREE):
        return float(levels[u])
    return sum(alike) / len(alike)


def place(region: ImageRegion, lines: BeamLines, line: int, row: float, level: float) -> float:
    """Range at which a line's ray in a row meets floor at that level; 0 where there is no row."""
    if row < 0:
        return 0.0
    column = float(lines.column[line]) + float(row) * float(lines.column_step[line])
    forward, left, up = (
        axis.columns[0] + column * (axis.columns[1] - axis.columns[0]) + axis.rows[int(row)]
        for axis in (region.forward, region.left, region.up)
    )
    return math.hypot(forward, left) * (level - region.camera.floor.d) / up


def doubt(
    ends: list[End], ranges: list[float], first: np.ndarray, outlying: list[bool], spacing: float, floor_lost: str
) -> None:
    """Take back what too few lines side by side saw, unless at the border, and lost floor that is not to count."""
    start, count = 0, len(ends)
    while start < count:
        stop = start
        while stop < count and numbered(ends[stop]):
            stop += 1
        group = range(start, stop)
        across = sum(ranges[u] * spacing for u in group)
        amid = start > 0 and stop < count and first[start - 1] >= 0 and first[stop] >= 0
        beside_drop = any(ends[u] == End.DROP for u in group)
        counts = floor_lost == "counts" or (floor_lost == "beside_drop" and beside_drop)
        shine = not beside_drop and all(outlying[u] for u in group)
        least = NARROWEST_FAR if shine else NARROWEST
        for u in group:
            if (amid and across < least) or (ends[u] == End.NO_RETURN and not counts):
                ends[u] = End.UNVERIFIED
        start = stop + 1


def worst(own: range, ends: list[End], ranges: list[float], clear: list[float]) -> tuple[float, float, float]:
    """Of a beam's lines the nearest number, or not seen, or free; how far all of them show floor."""
    numbers = [(ranges[u], 2.0 if ends[u] == End.DROP else 3.0) for u in own if numbered(ends[u])]
    free = all(ends[u] == End.REACHED_RANGE for u in own)
    nearest = min(numbers, key=lambda number: number[0]) if numbers else (math.inf if free else math.nan, 0.0)
    return *nearest, min(clear[u] for u in own)
