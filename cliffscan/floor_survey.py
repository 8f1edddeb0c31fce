"""What frames of the floor show of a camera: its mount, its sensor's noise, and the region that returns anything."""

import math
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, Region
from cliffscan.common.contract.limits import LEAST_NOISE
from cliffscan.services.capture.floor.noise import deviation, deviations
from cliffscan.services.capture.floor.tracker import FloorTracker, tracker_of
from cliffscan.services.capture.region import VIEWS, RegionLearner

UNITS = np.array([1e3, 180 / math.pi, 180 / math.pi])  # [mm], [deg], [deg] of a mount


class Noise(NamedTuple):
    """Standard deviations [1/m] of the inverse depth about the floor: about all of it, its near and its far half."""

    whole: float
    near: float
    far: float

    @classmethod
    def of(cls, frames: list[NDArray[np.float64]]) -> Self:
        """The noise of each frame's deviations (n,), from the nearest outward."""
        halves = [np.array_split(each, 2) for each in frames]
        near, far = (np.concatenate([each[half] for each in halves]) for half in (0, 1))
        return cls(*(max(deviation(each), LEAST_NOISE) for each in (np.concatenate([near, far]), near, far)))


class FloorSurvey:
    """Measures the floor in frames, each from the mount that it comes with.

    views: different ones that tell the region; 1 where somebody knows that there is no hole.
    frames, seen: how many there were, and in how many the floor was measured; region: None where all pixels return.
    note: why the floor was not measured in the last frame, or what is odd of it.
    """

    def __init__(self, views: int = VIEWS) -> None:
        self.frames = 0
        self.region: Region | None = None
        self.note = ""
        self._learner = RegionLearner(views)
        self._tracker: FloorTracker | None = None
        self._rows: list[tuple[float, ...]] = []  # nominal mount, measured one, residual, share
        self._errors: list[NDArray[np.float64]] = []

    def add(self, depth: NDArray[np.uint16], camera: Camera) -> None:
        """Take in a frame: (rows, columns) [mm]."""
        self.frames += 1
        self.region = self._learner.update(depth)
        tracker = self._tracker = tracker_of(camera.floor, self._tracker)
        floor = tracker.update(depth, camera)
        self.note = tracker.note
        if tracker.measured:
            self._rows.append((*camera.floor.mount(), *floor.mount(), tracker.residual, tracker.share))
            self._errors.append(deviations(depth, camera, floor))

    @property
    def seen(self) -> int:
        """In how many frames the floor was measured."""
        return len(self._rows)

    def mounts(self) -> NDArray[np.float64]:
        """Height [m], pitch and roll [rad] of each frame with a floor: (n, 3)."""
        return self._table()[:, 3:6]

    def errors(self) -> NDArray[np.float64]:
        """By how much these are more than the mount that the frame came with: (n, 3)."""
        return self.mounts() - self._table()[:, :3]

    def noise(self) -> Noise:
        """Of all frames with a floor, of which there must be one."""
        return Noise.of(self._errors)

    def fit(self) -> tuple[float, float]:
        """Medians: rms height [m] of the floor's pixels, and their share of the pixels that may have seen it."""
        residual, share = np.median(self._table()[:, 6:], axis=0)
        return float(residual), float(share)

    def _table(self) -> NDArray[np.float64]:
        return np.array(self._rows).reshape(-1, 8)
