"""What a simulated world truly is, as seen from where its robot stands."""

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats
from cliffscan.simulator.truth import BODY, floor_edge, obstacle
from cliffscan.simulator.world import World
from evaluation.truth.beam_truth import Truth
from evaluation.truth.sight import measurable

TOLERANCE = 0.10  # [m] by which a number may be too far or too near


def world_truth(world: World, camera: Camera, angles: Floats) -> Truth:
    """What is truly there in each beam. angles: (beams,) [rad] from the robot's heading."""
    edge = floor_edge(world, angles)
    first = np.minimum(edge, obstacle(world, angles, *BODY))
    drop, none = np.isfinite(edge) & measurable(camera, angles, edge), np.zeros(len(angles), dtype=bool)
    return Truth(edge, np.full(len(angles), TOLERANCE), first - TOLERANCE, drop, none, none, none)
