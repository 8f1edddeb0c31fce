"""What every sensor here is: a function from what returns light to the depth that is reported."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cliffscan.common.contract.camera import Camera
from cliffscan.simulator.kinect import Image, KinectModel, Millimetres, measure

# (inverse depth [1/m], 0 = no return; camera; model, of which what is lost by chance counts; random numbers) -> [mm]
Measure = Callable[[Image, Camera, KinectModel, np.random.Generator], Millimetres]


def reported(inverse: Image, camera: Camera, model: KinectModel, rng: np.random.Generator) -> Millimetres:
    """Depth [mm] of an inverse depth (rows, cols) [1/m] that is noisy already: in range, some lost by chance."""
    return measure(inverse, camera, replace(model, noise=0.0, step=0.0), rng)
