"""The Kinect's view of a depth image: what it loses, its noise and its millimetres.

The sensor measures the disparity b f / z of a speckle pattern. Its noise and its steps are constant in disparity, so in
inverse depth, and grow as z² in depth: Khoshelham and Elberink 2012.
"""

import math
from dataclasses import dataclass
from statistics import NormalDist
from typing import Self

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics

Image = NDArray[np.float32]
Millimetres = NDArray[np.uint16]

WIDTH, HEIGHT = 640, 480  # [px]
FOCAL_X = WIDTH / 2 / math.tan(math.radians(58.0) / 2)  # [px]
FOCAL_Y = HEIGHT / 2 / math.tan(math.radians(45.0) / 2)  # [px]
RANGE = (0.5, 4.5)  # [m]

TICKET_BITS = 12
NORMAL = np.array(  # equally likely normal deviates: a ticket into them costs a sixth of a draw from the distribution
    [NormalDist().inv_cdf((i + 0.5) / (1 << TICKET_BITS)) for i in range(1 << TICKET_BITS)], dtype=np.float32
)


@dataclass(frozen=True)
class KinectModel:
    """How far the sensor falls short of the exact depth. Raises ValueError for a value that means nothing."""

    noise: float = 1.425e-3  # [1/m] standard deviation of the inverse depth: noise · z² [m] in depth
    step: float = 2.85e-3  # [1/m] of inverse depth, 1/8 px of disparity: step · z² [m] in depth; 0 = none
    baseline: float = 0.075  # [m] from the camera to the projector on its right, the cause of shadows; 0 = none
    grazing: float = 0.05  # sine of the angle to a surface below which it returns nothing: floor 6 m away from 0.30 m
    dropout: float = 0.01  # share of the pixels lost at random

    def __post_init__(self) -> None:
        for name in ("noise", "step", "baseline"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} of {getattr(self, name)}, expected a finite value of 0 or more")
        for name in ("grazing", "dropout"):
            if not 0.0 <= getattr(self, name) < 1.0:
                raise ValueError(f"{name} of {getattr(self, name)}, expected 0 <= {name} < 1")

    @classmethod
    def ideal(cls) -> Self:
        """A sensor that loses nothing and errs by its rounding to millimetres alone."""
        return cls(noise=0.0, step=0.0, baseline=0.0, grazing=0.0, dropout=0.0)


def kinect_camera(height: float = 0.30, pitch: float = 0.0, roll: float = 0.0) -> Camera:
    """A Kinect `height` [m] over the floor, pitched down and rolled to the right [rad]: 640 x 480 px, 58° x 45°."""
    centre = Intrinsics(FOCAL_X, FOCAL_Y, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    return Camera(WIDTH, HEIGHT, centre, RANGE, FloorPlane.from_mount(height, pitch, roll))


def sense(depth: Image, camera: Camera, model: KinectModel, rng: np.random.Generator) -> Millimetres:
    """The image the sensor makes of an exact one: (rows, cols) [mm], 0 = no return.

    depth: (rows, cols) [m] along the optical axis, inf where there is nothing.
    """
    return measure(returns(depth, camera, model), camera, model, rng)


def returns(depth: Image, camera: Camera, model: KinectModel) -> Image:
    """Inverse depth [1/m] of what the sensor gets light back from; 0 elsewhere. Free of chance.

    Lost are pixels in the projector's shadow and surfaces seen at a grazing angle.
    depth: (rows, cols) [m], inf where there is nothing.
    """
    inverse = np.reciprocal(depth)
    kept = inverse.copy()
    drop_grazing(inverse, *camera.intrinsics, model.grazing, kept)
    drop_shadow(inverse, model.baseline * camera.intrinsics.fx, kept)
    return kept


def measure(inverse: Image, camera: Camera, model: KinectModel, rng: np.random.Generator) -> Millimetres:
    """Depth [mm] as the sensor reports it, 0 = no return: noisy, in steps, within its range, some of it lost by chance.

    inverse: (rows, cols) [1/m], 0 = no return.
    """
    tickets = rng.integers(1 << TICKET_BITS, size=inverse.shape, dtype=np.uint16)
    millimetres = np.empty(inverse.shape, dtype=np.uint16)
    quantise(inverse, tickets, NORMAL, model.noise, model.step, *camera.range, millimetres)
    hits = rng.poisson(-math.log1p(-model.dropout) * inverse.size)  # a pixel escapes with probability 1 - dropout
    millimetres.ravel()[rng.integers(inverse.size, size=hits)] = 0
    return millimetres


@njit(cache=True, error_model="numpy")
def drop_grazing(inverse: Image, fx: float, fy: float, cx: float, cy: float, threshold: float, kept: Image) -> None:
    """Zero in kept what is seen at an angle whose sine is below the threshold.

    On a plane n·p = k the inverse depth is n·ray / k, affine in (u, v), so its gradient gives n / k. Towards the border
    of the image the outermost pixels have no neighbour, and are taken to be level there.
    """
    rows, cols = inverse.shape
    rays = (np.arange(cols) - cx) / fx
    across = np.zeros(cols)  # how the inverse depth changes along a row
    for v in range(rows):
        y = (v - cy) / fy
        above, here, below, row = inverse[max(v - 1, 0)], inverse[v], inverse[min(v + 1, rows - 1)], kept[v]
        for u in range(1, cols - 1):
            across[u] = slope(here[u - 1], here[u], here[u + 1])
        for u in range(cols):  # without branches, for the processor's vectors
            x, w = rays[u], here[u]
            nx, ny = fx * across[u], fy * slope(above[u], w, below[u])
            nz = w - x * nx - y * ny
            lost = w * w < threshold * threshold * (nx * nx + ny * ny + nz * nz) * (x * x + y * y + 1.0)
            row[u] = np.float32(0.0) if lost else row[u]


@njit(cache=True)
def slope(before: float, here: float, after: float) -> float:
    """The smaller of the steps on either side of a pixel: the one that stays on its surface."""
    back, ahead = here - before, after - here
    return back if abs(back) < abs(ahead) else ahead


@njit(cache=True)
def drop_shadow(inverse: Image, baseline_px: float, kept: Image) -> None:
    """Zero in kept what the projector cannot see.

    What the camera has in column u lies in column u - b f / z for the projector, on the same row. Going left, that
    falls; where it exceeds the least so far, something nearer and further right stands in the projector's light.
    baseline_px: b f [m px].
    """
    rows, cols = inverse.shape
    for v in range(rows):
        leftmost = math.inf
        for u in range(cols - 1, -1, -1):
            if inverse[v, u] > 0.0:
                column = u - baseline_px * inverse[v, u]
                if column > leftmost:
                    kept[v, u] = 0.0
                else:
                    leftmost = column


@njit(cache=True)
def quantise(
    inverse: Image,
    tickets: NDArray[np.uint16],
    normal: Image,
    sigma: float,
    step: float,
    near: float,
    far: float,
    millimetres: Millimetres,
) -> None:
    """Write the depth [mm] of each pixel of inverse depth [1/m]; 0 where there is none, or outside near to far [m].

    tickets: which of the table's normal deviates each pixel gets; sigma, step: as in KinectModel.
    """
    rows, cols = inverse.shape
    for v in range(rows):
        for u in range(cols):
            w = inverse[v, u] + sigma * normal[tickets[v, u]]
            if step > 0.0:
                w = step * math.floor(w / step + 0.5)
            seen = inverse[v, u] > 0.0 and far * w >= 1.0 >= near * w
            millimetres[v, u] = np.uint16(1000.0 / w + 0.5) if seen else 0
