"""What a simulated world truly is: beam by beam from where its robot stands, and as a map of it should show."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple, Self

import numpy as np
from matplotlib.path import Path as Polygon

from cliffscan.common.contract.camera import Camera, Floats
from cliffscan.simulator.truth import BODY, Outline, floor_edge, obstacle, outlines
from cliffscan.simulator.world import Pose, World
from evaluation.truth.beam_truth import Mask, Truth
from evaluation.truth.sight import measurable

SPACING = 0.01  # [m] between two points of an edge
BESIDE = 1e-3  # [m] off a side of the floor: what is there tells what the side is
AT = 0.01  # [m] between a point and where the floor first ends towards it


class Ground(NamedTuple):
    """The floor plan of a world."""

    outlines: Sequence[Outline]
    edges: Floats  # (points, 2) [m] SPACING apart along every side of the floor that is a drop

    @classmethod
    def of(cls, world: World) -> Self:
        """The floor plan of a simulated world."""
        plan = cls(outlines(world), np.empty((0, 2)))
        sides = [drop_points(plan, outline.polygon) for outline in plan.outlines if outline.kind == "floor"]
        return plan._replace(edges=np.concatenate([*sides, plan.edges]))

    def inside(self, kind: str, points: Floats) -> Mask:
        """Which of the points (n, 2) [m] lie in a piece of that kind: (n,)."""
        found = np.zeros(len(points), dtype=bool)
        for outline in self.outlines:
            if outline.kind == kind:
                found |= Polygon(outline.polygon).contains_points(points)
        return found

    def obstacles(self) -> Floats:
        """Points (n, 2) [m] along the sides of all that stands in the way, SPACING apart."""
        rings = [outline.polygon for outline in self.outlines if outline.kind == "obstacle"]
        return np.concatenate([np.empty((0, 2)), *(points for ring in rings for points, _ in sides(ring))])


def drop_points(plan: Ground, ring: Floats) -> Floats:
    """The points (n, 2) [m] of a piece of floor (corners, 2), counter-clockwise, beside which there is no ground."""
    points, outward = map(np.concatenate, zip(*sides(ring), strict=True))
    beside = points + BESIDE * outward
    found: Floats = points[~plan.inside("floor", beside) & ~plan.inside("obstacle", beside)]
    return found


def sides(ring: Floats) -> Iterable[tuple[Floats, Floats]]:
    """For each side of a closed polygon (corners, 2) [m]: its points and the outward normal of each, two of (n, 2)."""
    for start, end in pairwise(ring):
        length = math.dist(start, end)
        count = max(1, round(length / SPACING))
        along = (np.arange(count) + 0.5) / count
        normal = np.array([end[1] - start[1], start[0] - end[0]]) / length
        yield start + along[:, None] * (end - start), np.tile(normal, (count, 1))


def seen(world: World, edges: Floats, viewpoints: Iterable[Pose], camera: Camera, reach: float) -> Mask:
    """Which points of edges (n, 2) [m] a perfect scan shows from at least one viewpoint, within reach [m]: (n,)."""
    found = np.zeros(len(edges), dtype=bool)
    for world.pose in viewpoints:
        x, y = (edges - world.pose[:2]).T
        angles, distances = np.arctan2(y, x) - world.pose.yaw, np.hypot(x, y)
        first = np.abs(floor_edge(world, angles) - distances) < AT
        found |= first & (distances <= reach) & measurable(camera, angles, distances)
    return found


def nearest(points: Floats, others: Floats) -> Floats:
    """Distance [m] from each point (n, 2) to the nearest of the others (m, 2): (n,), inf where there is none."""
    found = np.full(len(points), math.inf)
    for first in range(0, len(points), 1000):
        part = points[first : first + 1000, None] - others[None]
        if others.size:
            found[first : first + 1000] = np.sqrt((part**2).sum(axis=2)).min(axis=1)
    return found


TOLERANCE = 0.10  # [m] by which a number may be too far or too near


def world_truth(world: World, camera: Camera, angles: Floats) -> Truth:
    """What is truly there in each beam. angles: (beams,) [rad] from the robot's heading."""
    edge = floor_edge(world, angles)
    first = np.minimum(edge, obstacle(world, angles, *BODY))
    drop, none = np.isfinite(edge) & measurable(camera, angles, edge), np.zeros(len(angles), dtype=bool)
    return Truth(edge, np.full(len(angles), TOLERANCE), first - TOLERANCE, drop, none, none, none)
