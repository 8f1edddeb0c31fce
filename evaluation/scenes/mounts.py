"""Where the camera is: on a TurtleBot, level and 0.30 m high, or anywhere a robot may carry it."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cliffscan.common.contract.camera import Camera, Floats, FloorPlane, Intrinsics, Region, axes
from cliffscan.simulator.kinect import kinect_camera

HEIGHTS = (0.20, 1.00)  # [m]
PITCHES = (0.0, 35.0)  # [deg] looking down
ROLL = 3.0  # [deg] to either side
EDGES = (0.8, 3.0)  # [m] where edges are sought

Optics = Callable[[float, float, float], Camera]  # height [m], pitch down and roll to the right [rad]


def any_mount(rng: np.random.Generator, optics: Optics = kinect_camera, roll: float = ROLL) -> Camera:
    """A camera somewhere on a robot, rolled by up to `roll` [deg], that sees floor at the distances of EDGES."""
    while True:
        height, pitch = rng.uniform(*HEIGHTS), math.radians(rng.uniform(*PITCHES))
        camera = optics(height, pitch, math.radians(rng.uniform(-roll, roll)))
        near, far = floor_in_view(camera)
        if far - near > 0.5:
            return camera


def floor_in_view(camera: Camera) -> tuple[float, float]:
    """The nearest and the farthest distance [m] ahead at which floor is in the image, within EDGES."""
    camera = upright(camera)
    height, (_, fy, _, cy) = camera.floor.d, camera.intrinsics
    pitch = math.asin(-camera.floor.nz)
    low = pitch + math.atan((camera.height - 1 - cy) / fy)
    high = pitch - math.atan(cy / fy)
    far = height / math.tan(high) if high > 0.0 else math.inf
    near = height / math.tan(low) if low < math.pi / 2 else 0.0
    return max(EDGES[0], near + 0.15), min(EDGES[1], far - 0.3)


def pose(camera: Camera) -> tuple[Floats, Floats]:
    """The camera's position (3,) [m] and its rotation (3, 3) from the optical frame, both in the scan frame."""
    return np.array([0.0, 0.0, camera.floor.d]), np.stack(axes(camera.floor))


def moved(camera: Camera, pitch: float, roll: float = 0.0, lift: float = 0.0) -> Camera:
    """The camera tilted farther down and to the right [rad], and lifted [m]."""
    was = math.asin(-camera.floor.nz), math.atan2(-camera.floor.nx, -camera.floor.ny)
    floor = FloorPlane.from_mount(camera.floor.d + lift, was[0] + pitch, was[1] + roll)
    return replace(camera, floor=floor)


def upright(camera: Camera) -> Camera:
    """The same camera with its image turned by quarters until it leans by no more than 45°; the eyes are not turned."""
    quarters = round(camera.floor.mount()[2] / (math.pi / 2)) % 4
    for _ in range(quarters):
        camera = turned_back(camera)
    return camera


def turned_back(camera: Camera) -> Camera:
    """The camera rolled back by a quarter: what was down in its image is right, what was right is up."""
    (fx, fy, cx, cy), (nx, ny, nz, d), last = camera.intrinsics, camera.floor, camera.height - 1
    left, top, right, bottom = camera.region
    return replace(
        camera,
        width=camera.height,
        height=camera.width,
        intrinsics=Intrinsics(fy, fx, last - cy, cx),
        floor=FloorPlane(-ny, nx, nz, d),
        seen=camera.seen and Region(last - bottom, left, last - top, right),
    )
