"""A time-of-flight camera like the Kinect v2: noise that grows as less light comes back, and flying pixels.

The light that comes back falls with z², so the noise of the depth grows with it, above a part that is always there. A
pixel that looks at two surfaces reports a depth between them.
"""

import numpy as np

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.simulator.kinect import Image, KinectModel, Millimetres
from evaluation.sensors.model import reported

WIDTH, HEIGHT = 512, 424  # [px]
FOCAL = 365.0  # [px]
RANGE = (0.5, 4.5)  # [m]
STEADY = 1.0e-3  # [m] standard deviation of any depth
GROWING = 1.5e-3  # [1/m] and what z² adds to it
TOLD = 2.0e-3  # [1/m] what that comes to at a metre, as the camera says it
BEND = 0.02  # [1/m] between three pixels in a row: more is two surfaces


def flight_camera(height: float, pitch: float, roll: float) -> Camera:
    """A Kinect v2 `height` [m] over the floor, pitched down and rolled to the right [rad]. One lens: no baseline."""
    centre = Intrinsics(FOCAL, FOCAL, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    return Camera(WIDTH, HEIGHT, centre, RANGE, FloorPlane.from_mount(height, pitch, roll), TOLD, 0.0)


def measure(inverse: Image, camera: Camera, model: KinectModel, rng: np.random.Generator) -> Millimetres:
    """Depth [mm] as the sensor reports it, 0 = no return.

    inverse: (rows, cols) [1/m], 0 = no return; of the model only what is lost by chance counts.
    """
    mixed = fly(fly(inverse, rng).T, rng).T
    sigma = np.hypot(np.float32(STEADY) * mixed**2, np.float32(GROWING))
    noisy = np.maximum(mixed + sigma * rng.standard_normal(mixed.shape, dtype=np.float32), np.float32(1e-6))
    return reported(np.where(inverse > 0.0, noisy, np.float32(0.0)), camera, model, rng)


def fly(inverse: Image, rng: np.random.Generator) -> Image:
    """Each pixel at which a column (rows, cols) [1/m] bends, somewhere between it and the one above."""
    above, here, below = inverse[:-2], inverse[1:-1], inverse[2:]
    split = (np.abs(above - 2.0 * here + below) > BEND) & (np.minimum(above, here) > 0.0)
    part = rng.random(here.shape, dtype=np.float32)
    mixed = inverse.copy()
    mixed[1:-1] = np.where(split, here + part * (above - here), here)
    return mixed
