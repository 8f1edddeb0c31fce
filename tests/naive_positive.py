"""The projection of what stands on the floor, and the floor it stands on, as plainly as they are described."""

import math
from collections.abc import Iterator

import numpy as np

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import Camera
from cliffscan.services.positive.first_sight import BASE, UNEVEN
from cliffscan.services.positive.projection import ACROSS, CLOSE, DEVIATIONS
from tests import naive

Point = tuple[float, float]  # how far away and how high above the plane [m]


def projection(
    depth: np.ndarray,
    camera: Camera,
    grid: Grid,
    floor_band: float,
    robot_height: float,
    slope: float = 0.0,
    noise: float = 0.0,
) -> np.ndarray:
    """Positive obstacles. A beam that saw the floor or below it, and nothing in the way, is free.

    slope: rise per metre of the steepest floor; noise [1/m]: of the inverse depth; the paper's floor is flat and exact.
    """
    nearest = [math.nan] * grid.beams
    points = {}
    for column in range(camera.width):
        seen = list(column_of(depth, camera, column))
        deviations = [noise * int(depth[row, column]) / 1000 * camera.floor.d for row, _ in seen]
        bands = [max(floor_band, DEVIATIONS * deviation) for deviation in deviations]
        points.update(judged(seen, column, bands, floor_band, slope))
    for row, column, step in naive.pixels_of_beams(camera, grid):
        distance, height, standing = points.get((row, column), (math.nan, math.nan, False))
        if math.isnan(height) or height > robot_height:
            continue
        value = distance if standing else math.inf
        if math.isnan(nearest[step]) or nearest[step] > value:
            nearest[step] = value
    return np.array(nearest)


def column_of(depth: np.ndarray, camera: Camera, column: int) -> Iterator[tuple[int, Point]]:
    """What was measured in a column of the image, from the robot outward: row, and where the point is."""
    forward, left, up = naive.axes(camera)
    rows = sorted(range(camera.height), key=lambda row: up.dot(naive.ray(camera, row, column)))
    near, far = camera.range
    for row in rows:
        z = int(depth[row, column]) / 1000
        point = naive.ray(camera, row, column) * z
        if z > 0 and near <= z <= far and forward.dot(point) > 0:
            yield row, (math.hypot(forward.dot(point), left.dot(point)), up.dot(point) + camera.floor.d)


def judged(
    column: list[tuple[int, Point]], number: int, bands: list[float], floor_band: float, slope: float
) -> Iterator[tuple[tuple[int, int], tuple[float, float, bool]]]:
    """Of each point of a column, how far and how high it is, and whether it stands on the floor: above its band."""
    level, reach = first_floor([point for _, point in column], floor_band, slope)
    for (row, (distance, height)), band in zip(column, bands, strict=True):
        ahead = max(distance - reach, 0.0)
        highest = level + slope * min(ahead, float(ACROSS))
        standing = height > highest + band
        if not standing and height >= -band:
            reach += ahead
            if height <= highest + CLOSE:
                level = min(max(height, 0.0), highest)
        yield (row, number), (distance, height, standing)


def first_floor(points: list[Point], floor_band: float, slope: float) -> Point:
    """How high the floor is where it is first seen, and how far away that is."""
    if not points:
        return 0.0, 0.0
    distance, height = points[0]
    if floor_band / 2 < height <= slope * distance:
        for farther, higher in points[1:]:
            run, rise = farther - distance, higher - height
            if rise > run * slope + UNEVEN:
                break
            if run >= BASE * distance:
                as_from_a_foot = rise >= run * height / distance - UNEVEN
                return (height if as_from_a_foot else 0.0), distance
    return 0.0, distance
