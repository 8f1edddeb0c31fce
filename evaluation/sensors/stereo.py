"""Active stereo as the RealSense D4xx have it: noise of the disparity that neighbours share, and smeared steps.

A disparity is matched over a window of pixels. So neighbours err alike, and a small step of the disparity becomes a
slope as wide as the window. A large one stays a step: the windows on either side match different things.
"""

import numpy as np

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.simulator.kinect import Image, KinectModel, Millimetres
from evaluation.sensors.model import reported

WIDTH, HEIGHT = 848, 480  # [px]
BASELINE = 0.05  # [m] between its two eyes
RANGE = (0.3, 6.0)  # [m]
FOCALS = (640.0, 900.0)  # [px]
ERRORS = (0.08, 0.12)  # [px] standard deviation of the disparity
ALIKE = 5  # [px] across which neighbours err alike
REACH = 5  # [px] to either side that the matching window takes in
SMEARED = 4.0  # [px] of disparity, the largest step that becomes a slope


def stereo_camera(focal: float, error: float, height: float, pitch: float, roll: float) -> Camera:
    """A D4xx of that focal length [px] and error [px] of its disparity; height [m], pitch down and roll right [rad]."""
    centre = Intrinsics(focal, focal, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    floor = FloorPlane.from_mount(height, pitch, roll)
    return Camera(WIDTH, HEIGHT, centre, RANGE, floor, error / (BASELINE * focal), BASELINE)


def measure(inverse: Image, camera: Camera, model: KinectModel, rng: np.random.Generator) -> Millimetres:
    """Depth [mm] as the sensor reports it, 0 = no return, with the noise that the camera tells.

    inverse: (rows, cols) [1/m], 0 = no return; of the model only what is lost by chance counts.
    """
    step = SMEARED / (camera.baseline * camera.intrinsics.fx)
    smeared = smear(smear(inverse, step).T, step).T
    noisy = np.maximum(smeared + np.float32(camera.noise) * shared_noise(inverse.shape, rng), np.float32(1e-6))
    return reported(np.where(inverse > 0.0, noisy, np.float32(0.0)), camera, model, rng)


def smear(inverse: Image, step: float) -> Image:
    """The mean over the window along each column (rows, cols), of what differs by no more than step [1/m].

    A pixel above counts only with its counterpart below, so that a plane stays the plane that it is.
    """
    rows = len(inverse)
    total, count = inverse.copy(), np.ones_like(inverse)
    for k in range(1, REACH + 1):
        here, above, below = inverse[k : rows - k], inverse[: rows - 2 * k], inverse[2 * k :]
        alike = (np.abs(above - here) <= step) & (np.abs(below - here) <= step) & (np.minimum(above, below) > 0.0)
        total[k : rows - k] += np.where(alike, above + below, np.float32(0.0))
        count[k : rows - k] += np.where(alike, np.float32(2.0), np.float32(0.0))
    mean: Image = total / count
    return mean


def shared_noise(shape: tuple[int, ...], rng: np.random.Generator) -> Image:
    """Normal deviates of variance 1 that neighbours within ALIKE share in part: (rows, cols)."""
    rows, cols = shape
    white = rng.standard_normal((rows + ALIKE - 1, cols + ALIKE - 1), dtype=np.float32)
    along: Image = sum((white[k : k + rows] for k in range(1, ALIKE)), white[:rows])
    both: Image = sum((along[:, k : k + cols] for k in range(1, ALIKE)), along[:, :cols])
    return both / np.float32(ALIKE)
