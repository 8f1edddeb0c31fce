"""The setups: what camera sees which scenes. Each is scored by itself."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics, Region
from cliffscan.simulator.kinect import KinectModel, SensorModel, kinect_camera
from cliffscan.simulator.sensor_models import MODELS
from cliffscan.simulator.sensors import sensor_camera
from cliffscan.simulator.stereo import StereoModel
from evaluation.scenes import drops, safe
from evaluation.scenes.drops import Span
from evaluation.scenes.mounts import any_mount
from evaluation.scenes.scene import Scene
from evaluation.truth.scene_truth import LONG, SHORTEST
from evaluation.truth.sight import floor_in_sight

Rng = np.random.Generator
Build = Callable[[Rng, Span], Scene]

DROPS: tuple[Build, ...] = (drops.hole, drops.hole, drops.kerb, drops.kerb_5cm, drops.stairs, drops.stairwell,
                            drops.platform)  # fmt: skip
SAFE: tuple[Build, ...] = (safe.open_floor, safe.walls, safe.corridor, safe.boxes, safe.tables, safe.railings,
                           safe.sill, safe.ramp_down, safe.ramp_up, safe.lost_returns)  # fmt: skip
OPENINGS: tuple[Build, ...] = (drops.hole, drops.stairwell)  # that have corners
BUILD: dict[str, Build] = {
    build.__name__: build for build in (*DROPS, *SAFE, safe.glossy, safe.ramp_ahead, drops.low_step, safe.driven_step)
}

ANY_ROLL = 180.0  # [deg]
STEREO_SIZE, STEREO_RANGE, STEREO_BASELINE = (848, 480), (0.3, 6.0), 0.05  # [px], [m], [m]
FOCALS, ERRORS, SUBPIXELS = (640.0, 900.0), (0.08, 0.12), 32  # [px], [px] of disparity, its steps in a pixel
FLIGHT = "kinect_v2"
FLAT_HEIGHTS, FLAT_PITCHES = (0.2, 1.5), (-5.0, 60.0)  # [m], [deg]
FAN = np.radians(np.linspace(-29.0, 29.0, 59))  # [rad] of which some beam must see floor
BOTTOM_BORDER, OTHER_BORDER = (4, 24), (0, 16)  # [px] without returns
TIP, CORNER = 0.05, 0.10  # [m] of hole along the beam


def level(_rng: Rng) -> Camera:
    """A Kinect on a TurtleBot."""
    return kinect_camera()


def rolled(rng: Rng) -> Camera:
    """A Kinect anywhere on a robot, rolled by any angle."""
    return any_mount(rng, roll=ANY_ROLL)


def stereo_mount(rng: Rng) -> Camera:
    """A D4xx anywhere on a robot."""
    focal, error = rng.uniform(*FOCALS), rng.uniform(*ERRORS)
    return any_mount(rng, partial(stereo_camera, focal, error))


def stereo_camera(focal: float, error: float, height: float, pitch: float, roll: float) -> Camera:
    """A D4xx of that focal length [px] and error [px] of its disparity; height [m], pitch down and roll right [rad]."""
    (across, upright), floor = STEREO_SIZE, FloorPlane.from_mount(height, pitch, roll)
    centre = Intrinsics(focal, focal, (across - 1) / 2, (upright - 1) / 2)
    noise = error / (STEREO_BASELINE * focal)
    return Camera(across, upright, centre, STEREO_RANGE, floor, noise, STEREO_BASELINE)


def stereo_model(camera: Camera) -> StereoModel:
    """How that camera errs."""
    step = 1.0 / (SUBPIXELS * camera.baseline * camera.intrinsics.fx)
    return StereoModel(noise=camera.noise, step=step, baseline=camera.baseline)


def flight_mount(rng: Rng) -> Camera:
    """A time-of-flight camera anywhere on a robot."""
    return any_mount(rng, partial(sensor_camera, FLIGHT))


def bordered(rng: Rng) -> Camera:
    """A Kinect that has no returns at the border of its image, level or anywhere on a robot."""
    camera = kinect_camera() if rng.random() < 0.5 else any_mount(rng)
    left, top, right = rng.integers(*OTHER_BORDER, 3)
    bottom = rng.integers(*BOTTOM_BORDER)
    seen = Region(int(left), int(top), int(camera.width - 1 - right), int(camera.height - 1 - bottom))
    return replace(camera, seen=seen)


def flat_mount(rng: Rng) -> Camera:
    """A Kinect at any height, pitch and roll from which some floor is seen."""
    while True:
        height, pitch, roll = (rng.uniform(*span) for span in (FLAT_HEIGHTS, FLAT_PITCHES, (-ANY_ROLL, ANY_ROLL)))
        camera = kinect_camera(height, math.radians(pitch), math.radians(roll))
        if floor_in_sight(camera, FAN).any():
            return camera


class Setup(NamedTuple):
    """A camera, what it sees, and what must be found there."""

    camera: Callable[[Rng], Camera]
    drops: tuple[Build, ...] = DROPS
    safe: tuple[Build, ...] = SAFE
    model: Callable[[Camera], SensorModel] = lambda _camera: KinectModel()
    lengths: Span = LONG  # [m] of hole along a beam whose edge must be found

    def kind(self, number: int) -> str:
        """The kind of its scene of that number: in turn with a drop and without, all kinds as often."""
        both = [kinds for kinds in (self.drops, self.safe) if kinds]
        kinds = both[number % len(both)]
        return kinds[number // len(both) % len(kinds)].__name__


LEVEL, MOUNTED, FLAT = "level", "mounted", "flat"
GLOSSY = safe.glossy.__name__
SETUPS: dict[str, Setup] = {
    LEVEL: Setup(level),
    MOUNTED: Setup(any_mount),
    GLOSSY: Setup(level, drops=(), safe=(safe.glossy,)),
    "rolled": Setup(rolled),
    "stereo": Setup(stereo_mount, model=stereo_model),
    "flight": Setup(flight_mount, model=lambda _camera: MODELS[FLIGHT]),
    "border": Setup(bordered),
    "ramps": Setup(level, drops=(), safe=(safe.ramp_ahead,)),
    "corners": Setup(level, OPENINGS, (), lengths=(CORNER, SHORTEST)),
    "tips": Setup(level, OPENINGS, (), lengths=(TIP, CORNER)),
    "steps": Setup(level, (drops.low_step,), (safe.driven_step,)),
    FLAT: Setup(flat_mount, drops=(), safe=(safe.open_floor,)),
}
