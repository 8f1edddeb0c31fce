"""Small depth images of made-up places, for tests: a floor with holes and boxes, seen by any camera."""

import math

import numpy as np

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics, scan_axes

Box = tuple[float, float, float, float, float, float]  # x, y, z from and to [m], in the scan frame

HOLE: Box = (1.5, -0.6, -0.5, 2.4, 0.6, 0.0)


def camera(
    width: int = 64, height: int = 48, floor: FloorPlane | None = None, reach: tuple[float, float] = (0.4, 6.0)
) -> Camera:
    """A Kinect of fewer pixels."""
    focal = width / 2 / math.tan(math.radians(29))
    centre = (width - 1) / 2, (height - 1) / 2
    return Camera(width, height, Intrinsics(focal, focal, *centre), reach, floor or FloorPlane.from_mount(0.3))


def depth(
    camera: Camera,
    holes: list[Box] = [],  # noqa: B006
    boxes: list[Box] = [],  # noqa: B006
    wall: float = 5.0,
    ramp: tuple[float, float] | None = None,
) -> np.ndarray:
    """(rows, columns) [mm]: a floor with holes and boxes, a wall at x = `wall` [m], a ramp (foot [m], [deg])."""
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    with np.errstate(divide="ignore", invalid="ignore"):
        nearest = np.where(forward > 0, wall / forward, np.inf)
        ground = np.where(up < 0, -camera.floor.d / up, np.inf)
        for hole in holes:
            inside = _within(forward * ground, hole[0], hole[3]) & _within(left * ground, hole[1], hole[4])
            ground = np.where(inside, _leaves(camera, hole, forward, left, up), ground)
        if ramp:
            foot, rise = ramp[0], math.tan(math.radians(ramp[1]))
            climbs = (camera.floor.d + rise * foot) / (rise * forward - up)
            ground = np.where((climbs > 0) & (forward * climbs > foot), np.minimum(ground, climbs), ground)
        nearest = np.minimum(nearest, ground)
        for box in boxes:
            nearest = np.minimum(nearest, _enters(camera, box, forward, left, up))
    millimetres = np.where(np.isfinite(nearest) & (nearest < 65), nearest * 1000, 0)
    return np.round(millimetres).astype(np.uint16)


def _within(value: np.ndarray, low: float, high: float) -> np.ndarray:
    return (value > low) & (value < high)


def _slabs(camera: Camera, box: Box, *rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depths at which each ray enters and leaves a box; origin above the scan frame's."""
    origin = (0.0, 0.0, camera.floor.d)
    ends = [
        [(bound - start) / ray for bound in (box[axis], box[axis + 3])]
        for axis, (start, ray) in enumerate(zip(origin, rays, strict=True))
    ]
    enters = np.max([np.minimum(*pair) for pair in ends], axis=0)
    leaves = np.min([np.maximum(*pair) for pair in ends], axis=0)
    return enters, leaves


def _enters(camera: Camera, box: Box, *rays: np.ndarray) -> np.ndarray:
    enters, leaves = _slabs(camera, box, *rays)
    return np.where((enters < leaves) & (enters > 0), enters, np.inf)


def _leaves(camera: Camera, box: Box, *rays: np.ndarray) -> np.ndarray:
    return _slabs(camera, box, *rays)[1]


SCENES = {
    "open floor": {},
    "hole": {"holes": [HOLE]},
    "hole and box": {"holes": [HOLE], "boxes": [(1.0, 0.5, 0.0, 1.3, 0.8, 0.3)]},
    "nothing but a wall": {"wall": 0.6},
    "low and high boxes": {"boxes": [(1.2, -0.4, 0.0, 1.4, 0.0, 0.1), (1.6, 0.1, 0.5, 1.8, 0.6, 0.9)]},
    "a ramp whose foot is not seen": {"ramp": (0.36, 5.0)},
    "a low top whose face is not seen": {"boxes": [(0.3, -1.0, 0.0, 1.2, 1.0, 0.05)]},
    "kerb": {"holes": [(1.2, -5.0, -0.05, 5.0, 5.0, 0.0)]},
}
