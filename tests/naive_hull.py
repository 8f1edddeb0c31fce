"""A hull that is moved in small steps and sampled densely: the slow twin of safety/polygon_collision.py."""

import math
from functools import cache

import numpy as np

STEP = 0.002  # [m] between two samples of an edge


@cache
def border(corners):
    """Points (2, n) of a polygon's border, STEP apart at most."""
    points = []
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        count = max(math.ceil(math.hypot(bx - ax, by - ay) / STEP), 1)
        points += [(ax + (bx - ax) * k / count, ay + (by - ay) * k / count) for k in range(count)]
    return np.array(points).T


def apart(corners, pose, point):
    """How far the border of a hull at a pose (x, y, heading) is from a point, by its samples."""
    x, y, theta = pose
    dx, dy = point[0] - x, point[1] - y
    px, py = math.cos(theta) * dx + math.sin(theta) * dy, math.cos(theta) * dy - math.sin(theta) * dx
    samples = border(corners)
    return float(np.hypot(px - samples[0], py - samples[1]).min())


def pose_on_arc(side, curvature, way):
    """Where a robot is that began at the origin and drove so far [m], forward (1) or backward (-1)."""
    turned = side * way * curvature
    if abs(turned) < 1e-9:
        return side * way, 0.0, turned
    return math.sin(turned) / curvature, (1.0 - math.cos(turned)) / curvature, turned
