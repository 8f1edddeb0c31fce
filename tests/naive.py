"""The paper's algorithms, written down as slowly and plainly as they are described: what the fast code answers to.

Points are taken one by one. Where the paper has a level camera and y' = 0.3 m, the floor plane is any.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from common.geometry import Camera
from common.grid import Grid


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


def projection(depth: np.ndarray, camera: Camera, grid: Grid, floor_band: float, robot_height: float) -> np.ndarray:
    """Positive obstacles. A beam that saw the floor or below it, and nothing in the way, is free."""
    nearest = [math.nan] * grid.beams
    for step, x, y, height in points(depth, camera, grid):
        if height > robot_height:
            continue
        distance = math.sqrt(x**2 + y**2) if height > floor_band else math.inf
        if math.isnan(nearest[step]) or nearest[step] > distance:
            nearest[step] = distance
    return np.array(nearest)


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
