"""What a simulated world truly is, as seen from where its robot stands."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, Floats, axes
from cliffscan.common.contract.messages import LaserScan
from cliffscan.simulator.truth import BODY, floor_edge, obstacle
from cliffscan.simulator.world import World
from experiments.score import Truth

SLACK = 1e-6  # [px] so that the outermost beams, which graze the image's border, are within it


def truth_of(world: World, camera: Camera, angles: Floats) -> Truth:
    """What is truly there in each beam. angles: (beams,) [rad] from the robot's heading."""
    edge = floor_edge(world, angles)
    return Truth(edge, measurable(camera, angles, edge), obstacle(world, angles, *BODY))


def measurable(camera: Camera, angles: Floats, distances: Floats) -> NDArray[np.bool_]:
    """Whether floor at these azimuths [rad] and distances [m] is within the camera's image and range: (n,)."""
    forward, left, up = axes(camera.floor)
    with np.errstate(invalid="ignore", divide="ignore"):  # an infinite distance is nowhere in the image
        ahead, aside = distances * np.cos(angles), distances * np.sin(angles)
        x, y, z = (ahead * forward[i] + aside * left[i] - camera.floor.d * up[i] for i in range(3))
        fx, fy, cx, cy = camera.intrinsics
        column, row = fx * x / z + cx, fy * y / z + cy
    near, far = camera.range
    within = (np.abs(column - (camera.width - 1) / 2) <= camera.width / 2 + SLACK) & (row <= camera.height - 0.5)
    seen: NDArray[np.bool_] = within & (row >= -0.5) & (z >= near) & (z <= far)
    return seen


def angles_of(scan: LaserScan) -> Floats:
    """Azimuth [rad] of each beam: (beams,)."""
    return scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges), dtype=np.float64)
