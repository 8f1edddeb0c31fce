"""Noisy frames of a case, with the floor plane that the service would be given."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchmarks.accuracy.cases import Case, camera_of, scene_of
from cliffscan.common.contract.camera import Camera, scan_axes
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.services.capture.thinning import thinned
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.simulator.faces import Faces, pack
from cliffscan.simulator.kinect import Image, Millimetres, SensorModel, measure, returns
from cliffscan.simulator.rasteriser import depth_image
from evaluation.scenes.mounts import moved, pose
from evaluation.scenes.polygons import contains
from evaluation.scenes.scene import Scene

KNOWN, UNKNOWN, WOBBLING = "known", "unknown", "wobbling"
PLANES = (KNOWN, UNKNOWN, WOBBLING)
TRACKED = "tracked"

TILT = 2.0  # [deg] by which pitch and roll are unknown, and by which a wobbling robot nods
LIFT = 0.01  # [m] by which the height is unknown
RATE, NODS = 30.0, 5.0  # [Hz] frames and nods
WOBBLE_FRAMES, SETTLING = 17, 5  # frames of a wobbling sequence, and how many of them are not scored
ROBOT = PositiveConfig().robot_height  # [m]
SETTLED = 3  # frames that a tracker gets of a still scene


class Frame(NamedTuple):
    """A frame, and what is only known in a simulation: the camera's true place."""

    depth: Millimetres
    camera: Camera  # with the floor that the frame is said to have
    true: Camera
    plane: str  # the plane mode, and whether it was tracked


class Sensor:
    """A noisy sensor before a scene."""

    def __init__(self, scene: Scene, rng: np.random.Generator, model: SensorModel) -> None:
        self.scene, self._rng = scene, rng
        self._model = replace(model, dropout=scene.dropout, grazing=scene.grazing)
        self._faces: Faces = pack(scene.faces)

    def exact(self, camera: Camera) -> Image:
        """Exact depth [m]: (rows, cols), inf = nothing."""
        return depth_image(self._faces, *pose(camera), camera)

    def frame(self, camera: Camera) -> Millimetres:
        """A frame as the sensor reports it: (rows, cols) [mm]."""
        exact = self.exact(camera)
        inverse = returns(exact, camera, self._model)
        if self.scene.glossy:
            inverse[self._mirrored(exact, camera)] = 0.0
        left, top, right, bottom = camera.region
        returning = np.zeros_like(inverse)
        returning[top : bottom + 1, left : right + 1] = inverse[top : bottom + 1, left : right + 1]
        return measure(returning, camera, self._model, self._rng)

    def _mirrored(self, exact: Image, camera: Camera) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Which pixels show the floor within a glossy patch: (rows, cols)."""
        forward, left, up = (axis.table() for axis in scan_axes(camera))
        on_floor = np.abs(up * exact + camera.floor.d) < 1e-3
        points = np.stack([forward[on_floor], left[on_floor]], axis=-1) * exact[on_floor][:, None]
        lost = np.zeros(exact.shape, dtype=bool)
        lost[on_floor] = np.any([contains(patch, points) for patch in self.scene.glossy], axis=0)
        return lost


def frames_of(case: Case, plane: str) -> Iterator[Frame]:
    """The frames of a case that are scored in a plane mode; those of a wrong plane once more with it tracked."""
    camera, rng = camera_of(case), case.rng(plane)
    sensor = Sensor(scene_of(case), rng, case.setup.model(camera))
    if plane == KNOWN:
        yield Frame(sensor.frame(camera), camera, camera, plane)
    elif plane == UNKNOWN:
        yield from still(sensor, camera, rng)
    else:
        yield from nodding(sensor, camera)


def as_sent(frame: Frame, every: int) -> Frame:
    """The frame as `capture` sends it over a thin link: one of `every` columns, or all of it where that is 1."""
    if every == 1:
        return frame
    depth, camera = thinned(frame.depth, frame.camera, every, ROBOT)
    return frame._replace(depth=depth, camera=camera)


def still(sensor: Sensor, true: Camera, rng: np.random.Generator) -> Iterator[Frame]:
    """One frame of a camera whose pitch, roll and height are a little other than said."""
    pitch, roll = np.radians(rng.uniform(-TILT, TILT, 2))
    said = moved(true, pitch, roll, rng.uniform(-LIFT, LIFT))
    shots = [sensor.frame(true) for _ in range(SETTLED)]
    yield Frame(shots[-1], said, true, UNKNOWN)
    tracker = FloorTracker(said.floor)
    planes = [tracker.update(shot, said) for shot in shots]
    yield Frame(shots[-1], replace(said, floor=planes[-1]), true, f"{UNKNOWN}, {TRACKED}")


def nodding(sensor: Sensor, said: Camera) -> Iterator[Frame]:
    """A sequence of a camera that nods around the plane that is said."""
    tracker = FloorTracker(said.floor)
    for number in range(WOBBLE_FRAMES):
        nod = math.radians(TILT) * math.sin(2.0 * math.pi * NODS * number / RATE + 0.5)
        true = moved(said, nod)
        shot = sensor.frame(true)
        plane = tracker.update(shot, said)
        if number >= SETTLING:
            yield Frame(shot, said, true, WOBBLING)
            yield Frame(shot, replace(said, floor=plane), true, f"{WOBBLING}, {TRACKED}")
