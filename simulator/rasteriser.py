"""Exact depth images of flat faces.

Along the image plane the inverse depth 1/z of a plane is affine in (u, v). So a face is its convex outline on the
image, filled row by row with a straight line of 1/z, and the nearest face is the one of the largest 1/z.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, Floats
from cliffscan.simulator.faces import Faces

Depth = NDArray[np.float32]

NEAR = 0.01  # [m] nothing nearer is drawn, so that nothing behind the camera is projected
SLACK = 1e-9  # [px] widens every outline, so that rounding opens no seam between neighbours


def depth_image(faces: Faces, position: Floats, rotation: Floats, camera: Camera) -> Depth:
    """Depth along the optical axis [m] of the nearest face at each pixel's centre: (rows, cols), inf = none.

    position: (3,) [m] of the camera in the world; rotation: (3, 3) from its optical frame to the world's.
    Exact for flat faces, up to the rounding of float32.
    """
    corners = (faces.corners - position) @ rotation
    inverse = np.zeros((camera.height, camera.width), dtype=np.float32)
    draw(corners, faces.starts, *camera.intrinsics, inverse)
    invert(inverse)
    return inverse


@njit(cache=True)
def draw(
    corners: Floats, starts: NDArray[np.int64], fx: float, fy: float, cx: float, cy: float, inverse: Depth
) -> None:
    """Raise each pixel's inverse depth [1/m] to that of the nearest face.

    corners: (n, 3) [m] in the optical frame; starts: as in Faces; inverse: (rows, cols).
    """
    rows, cols = inverse.shape
    ramp = np.arange(cols).astype(np.float32)
    left, right = np.empty(rows), np.empty(rows)
    largest = 0
    for face in range(len(starts) - 1):
        largest = max(largest, starts[face + 1] - starts[face])
    outline = np.empty((largest + 1, 2))
    for face in range(len(starts) - 1):
        polygon = corners[starts[face] : starts[face + 1]]
        across, down, at_origin = inverse_depth_plane(polygon, fx, fy, cx, cy)
        if at_origin == -math.inf:
            continue
        count = project(polygon, fx, fy, cx, cy, outline)
        first, last = spans(outline[:count], left, right)
        for v in range(first, last + 1):
            start = max(0, math.ceil(left[v] - SLACK))
            stop = min(cols - 1, math.floor(right[v] + SLACK)) + 1
            if start < stop:
                begin = np.float32(across * start + down * v + at_origin)
                fill(inverse[v, start:stop], ramp, begin, np.float32(across))


@njit(cache=True)
def inverse_depth_plane(polygon: Floats, fx: float, fy: float, cx: float, cy: float) -> tuple[float, float, float]:
    """The coefficients of 1/z = a u + b v + c on the polygon's plane; c = -inf where the camera is behind it."""
    first, second = polygon[1] - polygon[0], polygon[2] - polygon[0]
    nx = first[1] * second[2] - first[2] * second[1]
    ny = first[2] * second[0] - first[0] * second[2]
    nz = first[0] * second[1] - first[1] * second[0]
    offset = nx * polygon[0, 0] + ny * polygon[0, 1] + nz * polygon[0, 2]
    if offset >= 0.0:
        return 0.0, 0.0, -math.inf
    a, b = nx / (offset * fx), ny / (offset * fy)
    return a, b, nz / offset - a * cx - b * cy


@njit(cache=True)
def project(polygon: Floats, fx: float, fy: float, cx: float, cy: float, outline: Floats) -> int:
    """Write the pixels [px] of the part of a polygon beyond NEAR into outline; return how many corners it has."""
    count = 0
    for i in range(len(polygon)):
        here, before = polygon[i], polygon[i - 1]
        if (here[2] >= NEAR) != (before[2] >= NEAR):
            share = (NEAR - before[2]) / (here[2] - before[2])
            outline[count, 0] = cx + fx * (before[0] + share * (here[0] - before[0])) / NEAR
            outline[count, 1] = cy + fy * (before[1] + share * (here[1] - before[1])) / NEAR
            count += 1
        if here[2] >= NEAR:
            outline[count, 0] = cx + fx * here[0] / here[2]
            outline[count, 1] = cy + fy * here[1] / here[2]
            count += 1
    return count


@njit(cache=True)
def spans(outline: Floats, left: Floats, right: Floats) -> tuple[int, int]:
    """Where each row enters and leaves a convex outline [px]; returns the first and last row it touches."""
    rows = len(left)
    if len(outline) == 0:
        return 0, -1
    first = max(0, math.ceil(outline[:, 1].min() - SLACK))
    last = min(rows - 1, math.floor(outline[:, 1].max() + SLACK))
    left[first : last + 1] = math.inf
    right[first : last + 1] = -math.inf
    for i in range(len(outline)):
        (u0, v0), (u1, v1) = outline[i - 1], outline[i]
        if v0 > v1:
            u0, v0, u1, v1 = u1, v1, u0, v0
        begin = max(first, math.ceil(v0 - SLACK))
        end = min(last, math.floor(v1 + SLACK))
        for v in range(begin, end + 1):
            if v1 - v0 < SLACK:
                left[v], right[v] = min(left[v], u0, u1), max(right[v], u0, u1)
            else:
                u = u0 + (u1 - u0) * min(max((v - v0) / (v1 - v0), 0.0), 1.0)
                left[v], right[v] = min(left[v], u), max(right[v], u)
    return first, last


@njit(cache=True)
def fill(row: Depth, ramp: Depth, begin: np.float32, slope: np.float32) -> None:
    """Raise a row's pixels to a line of inverse depth [1/m] that starts at `begin`."""
    for i in range(len(row)):
        value = begin + slope * ramp[i]
        row[i] = value if value > row[i] else row[i]


@njit(cache=True, error_model="numpy")
def invert(image: Depth) -> None:
    """Turn inverse depth [1/m] into depth [m] in place; 0 becomes inf."""
    for v in range(image.shape[0]):
        for u in range(image.shape[1]):
            image[v, u] = np.float32(1.0) / image[v, u]
