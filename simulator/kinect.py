"""The first Kinect's view of a depth image, and what any depth sensor loses of one.

The Kinect measures the disparity b f / z of a speckle pattern. Its noise and its steps are constant in disparity, so in
inverse depth, and grow as z² in depth: Khoshelham and Elberink 2012.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from statistics import NormalDist
from typing import ClassVar, Self

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.simulator.sensors import SENSORS, sensor_camera

Image = NDArray[np.float32]
Millimetres = NDArray[np.uint16]

RANGE = SENSORS["kinect"].range  # [m]

TICKET_BITS = 12
NORMAL = np.array(  # equally likely normal deviates: a ticket into them costs a sixth of a draw from the distribution
    [NormalDist().inv_cdf((i + 0.5) / (1 << TICKET_BITS)) for i in range(1 << TICKET_BITS)], dtype=np.float32
)


def draw_tickets(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.uint16]:
    """A place in NORMAL for each pixel."""
    return rng.integers(1 << TICKET_BITS, size=shape, dtype=np.uint16)


@dataclass(frozen=True, kw_only=True)
class SensorModel(ABC):
    """How far a sensor falls short of the exact depth. Raises ValueError for a value that means nothing."""

    SHARES: ClassVar = ("grazing", "dropout")

    baseline: float  # [m] from the camera to its second eye or projector on its right, the cause of shadows; 0 = none
    grazing: float = 0.05  # sine of the angle to a surface below which it returns nothing: floor 6 m away from 0.30 m
    dropout: float = 0.01  # share of the pixels lost at random

    def __post_init__(self) -> None:
        for name in (each.name for each in fields(self)):
            value = getattr(self, name)
            if name in self.SHARES and not 0.0 <= value < 1.0:
                raise ValueError(f"{name} of {value}, expected 0 <= {name} < 1")
            if not 0.0 <= value < math.inf:
                raise ValueError(f"{name} of {value}, expected a finite value of 0 or more")

    @abstractmethod
    def millimetres(self, inverse: Image, reach: tuple[float, float], rng: np.random.Generator) -> Millimetres:
        """Depth (rows, cols) [mm] as the sensor reports it, 0 = none or outside its reach [m]: noisy and in steps.

        inverse: (rows, cols) [1/m], 0 = no return.
        """


@dataclass(frozen=True, kw_only=True)
class KinectModel(SensorModel):
    """A camera and a projector of structured light."""

    noise: float = 1.425e-3  # [1/m] standard deviation of the inverse depth: noise · z² [m] in depth
    step: float = 2.85e-3  # [1/m] of inverse depth, 1/8 px of disparity: step · z² [m] in depth; 0 = none
    baseline: float = SENSORS["kinect"].baseline

    @classmethod
    def ideal(cls) -> Self:
        """A sensor that loses nothing and errs by its rounding to millimetres alone."""
        return cls(noise=0.0, step=0.0, baseline=0.0, grazing=0.0, dropout=0.0)

    def millimetres(self, inverse: Image, reach: tuple[float, float], rng: np.random.Generator) -> Millimetres:
        """See SensorModel."""
        tickets = draw_tickets(inverse.shape, rng)
        reported = np.empty(inverse.shape, dtype=np.uint16)
        quantise(inverse, tickets, NORMAL, self.noise, self.step, *reach, reported)
        return reported


def kinect_camera(height: float = 0.30, pitch: float = 0.0, roll: float = 0.0) -> Camera:
    """A Kinect `height` [m] over the floor, pitched down and rolled to the right [rad]: 640 x 480 px, 58° x 45°."""
    return sensor_camera("kinect", height, pitch, roll)


def sense(depth: Image, camera: Camera, model: SensorModel, rng: np.random.Generator) -> Millimetres:
    """The image the sensor makes of an exact one: (rows, cols) [mm], 0 = no return.

    depth: (rows, cols) [m] along the optical axis, inf where there is nothing.
    """
    return measure(returns(depth, camera, model), camera, model, rng)


def returns(depth: Image, camera: Camera, model: SensorModel) -> Image:
    """Inverse depth [1/m] of what the sensor gets light back from; 0 elsewhere. Free of chance.

    Lost are pixels that the projector or second eye does not see, and surfaces seen at a grazing angle.
    depth: (rows, cols) [m], inf where there is nothing.
    """
    inverse = np.reciprocal(depth)
    kept = inverse.copy()
    drop_grazing(inverse, *camera.intrinsics, model.grazing, kept)
    drop_shadow(inverse, model.baseline * camera.intrinsics.fx, kept)
    return kept


def measure(inverse: Image, camera: Camera, model: SensorModel, rng: np.random.Generator) -> Millimetres:
    """Depth [mm] as the sensor reports it, 0 = no return: noisy, in steps, within its range, some of it lost by chance.

    inverse: (rows, cols) [1/m], 0 = no return.
    """
    millimetres = model.millimetres(inverse, camera.range, rng)
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


@njit(cache=True, error_model="numpy")
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

    tickets: which of the table's normal deviates each pixel gets; sigma, step: as in KinectModel. Its loops are without
    branches, for the processor's vectors.
    """
    rows, cols = inverse.shape
    noisy = np.empty(cols)
    for v in range(rows):
        exact, places, row = inverse[v], tickets[v], millimetres[v]
        for u in range(cols):
            noisy[u] = exact[u] + sigma * normal[places[u]]
        if step > 0.0:
            for u in range(cols):
                noisy[u] = step * math.floor(noisy[u] / step + 0.5)
        for u in range(cols):
            w = noisy[u]
            seen = (exact[u] > 0.0) & (far * w >= 1.0) & (near * w <= 1.0)
            row[u] = np.uint16(np.int32(1000.0 / w + 0.5 if seen else 0.0))
