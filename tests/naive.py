"""The algorithms, written down as slowly and plainly as they are described: what the fast code answers to.

Of the paper's, points are taken one by one; where it has a level camera and y' = 0.3 m, the floor plane is any.
"""

import math
from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import numpy as np
from cliffscan.services.negative.column_edges import AGREE, NARROWEST, SIDE

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Camera
from cliffscan.common.perception.floor_points import FloorPoints
from cliffscan.common.perception.image_region import ImageRegion
from cliffscan.services.negative.floor_following import End, FloorCriteria
from cliffscan.services.negative.methods.near_edge import APART
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
    points: FloorPoints, grid: Grid, criteria: FloorCriteria, floor_lost: str, baseline: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ours: each column is followed over the floor, to where it ends. The beams' ranges, evidence and clear."""
    region, height = points.region, np.float32(points.region.camera.floor.d)
    rates, order = region.up.single(-1.0), rows_outward(region, criteria)
    columns = range(region.shape[1])
    if not order:
        return np.full(grid.beams, math.nan), np.zeros(grid.beams), np.zeros(grid.beams)
    traced = [naive_trace.floor_trace(points.heights, order, rates, height, criteria, column) for column in columns]
    ends, rows, levels, sure, sure_levels = (list(each) for each in zip(*traced, strict=True))
    outward = 1 if order[-1] > order[0] else -1
    disparity = baseline * region.camera.intrinsics.fx
    for u in columns:
        lost = ends[u] == End.NO_RETURN and not region.transposed
        if lost and naive_trace.shadowed(points.heights, rates, height, u, rows[u], outward, disparity):
            ends[u] = End.OCCLUDED
    averages = [averaged(ends, rows, levels, u) for u in columns]
    places = [place(region, u, max(rows[u], 0), averages[u]) for u in columns]
    clear = [surely(region, u, places[u], rows[u], sure[u], sure_levels[u]) for u in columns]
    doubt(ends, places, floor_lost)
    return of_beams(ends, places, clear, grid)


def rows_outward(region: ImageRegion, criteria: FloorCriteria) -> list[int]:
    """The rows that see floor, near to far: of those that see it within a centimetre of each other, the nearest."""
    columns = [0, region.shape[1] // 2, region.shape[1] - 1]
    rows = list(range(region.shape[0]))
    if region.up.rows[0] > region.up.rows[1]:
        rows.reverse()
    chosen, before = [], None
    for row in rows:
        downward = [-(region.up.rows[row] + region.up.columns[column]) for column in columns]
        inverse = [rate / region.camera.floor.d for rate in downward]
        steps = [math.floor(1 / (APART * max(each, 0.5 / criteria.far))) for each in inverse]
        if steps != before and any(each > 0.5 / criteria.far and each > 0 for each in inverse):
            chosen.append(row)
        before = steps
    return chosen


def numbered(end: End) -> bool:
    return end in (End.DROP, End.NO_RETURN)


def averaged(ends: list[End], rows: list[int], levels: list[np.float32], u: int) -> float:
    """A column's floor level, averaged with its neighbours' that ended likewise, if that is about the same."""
    beside = range(max(u - SIDE, 0), min(u + SIDE + 1, len(ends)))
    alike = [float(levels[k]) for k in beside if numbered(ends[k]) and rows[k] >= 0]
    if not (numbered(ends[u]) and rows[u] >= 0 and abs(sum(alike) / len(alike) - levels[u]) < AGREE):
        return float(levels[u])
    return sum(alike) / len(alike)


def place(region: ImageRegion, u: int, row: int, level: float) -> tuple[float, float, float]:
    """Azimuth and range at which a pixel's ray meets floor at that level, and how much of azimuth the pixel covers."""
    forward, left, up = (axis.columns[u] + axis.rows[row] for axis in (region.forward, region.left, region.up))
    depth = np.divide(level - region.camera.floor.d, up)
    across = [axis.columns[1] - axis.columns[0] for axis in (region.forward, region.left)]
    width = abs(across[1] * forward - across[0] * left) / (forward**2 + left**2)
    return math.atan2(left, forward), math.hypot(forward, left) * depth, width


def surely(
    region: ImageRegion, u: int, end: tuple[float, float, float], row: int, sure: int, level: float
) -> tuple[float, float]:
    """Azimuth and range up to which a column shows floor throughout: to its end, or to where it was last sure."""
    if sure < 0:
        return end[0], 0.0
    return end[:2] if sure == row else place(region, u, sure, level)[:2]


def doubt(ends: list[End], places: list[tuple[float, float, float]], floor_lost: str) -> None:
    """Take back what too few columns side by side saw, unless at the border, and lost floor that is not to count."""
    first, count = 0, len(ends)
    while first < count:
        stop = first
        while stop < count and numbered(ends[stop]):
            stop += 1
        group = range(first, stop)
        across = sum(places[u][1] * places[u][2] for u in group)
        narrow = first > 0 and stop < count and across < NARROWEST
        beside_drop = any(ends[u] == End.DROP for u in group)
        counts = floor_lost == "counts" or (floor_lost == "beside_drop" and beside_drop)
        for u in group:
            if narrow or (ends[u] == End.NO_RETURN and not counts):
                ends[u] = End.UNVERIFIED
        first = stop + 1


def of_beams(
    ends: list[End], places: list[tuple[float, float, float]], clear: list[tuple[float, float]], grid: Grid
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each beam tells the worst of the columns it listens to: the nearest number, or not seen, or free."""
    half = grid.increment / 2
    told = []
    for angle in grid.angles():
        heard = [u for u, (azimuth, _, width) in enumerate(places) if abs(azimuth - angle) <= max(width, half)]
        heard = heard or [u for u in range(len(places)) if is_nearest(places, u, angle)]
        numbers = [(places[u][1], 2.0 if ends[u] == End.DROP else 3.0) for u in heard if numbered(ends[u])]
        closed = between_closed(ends, places, angle)
        free = heard and all(ends[u] == End.REACHED_RANGE for u in heard) and not closed
        nearest = min(numbers, key=lambda number: number[0]) if numbers else (math.inf if free else math.nan, 0.0)
        doubtful = [u for u in range(len(places)) if crosses(places[u], clear[u][0], angle, half)]
        told.append((*nearest, min(clear[u][1] for u in heard + closed + doubtful) if heard else 0.0))
    ranges, evidence, free_up_to = zip(*told, strict=True)
    return np.array(ranges), np.array(evidence), np.array(free_up_to)


def crosses(end: tuple[float, float, float], doubted: float, angle: float, half: float) -> bool:
    """Whether a column that was no longer sure beyond one azimuth led over an angle on the way to its end."""
    azimuth, _, width = end
    reach = max(width, half)
    return doubted != azimuth and min(azimuth, doubted) - reach <= angle <= max(azimuth, doubted) + reach


def between_closed(ends: list[End], places: list[tuple[float, float, float]], angle: float) -> list[int]:
    """The neighbouring columns, neither of them free, between which an angle lies."""
    spans = [sorted((one[0], other[0])) for one, other in pairwise(places)]
    pairs = [(u, u + 1) for u, (low, high) in enumerate(spans) if low <= angle <= high]
    return [u for pair in pairs if End.REACHED_RANGE not in (ends[pair[0]], ends[pair[1]]) for u in pair]


def is_nearest(places: list[tuple[float, float, float]], u: int, angle: float) -> bool:
    """Whether an angle lies between a column and the middle between it and a neighbour."""
    beside = [places[k][0] for k in (u - 1, u + 1) if 0 <= k < len(places)]
    middles = [places[u][0], *((places[u][0] + each) / 2 for each in beside)]
    return min(middles) <= angle <= max(middles)
