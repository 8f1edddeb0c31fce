"""When enough frames have been collected: the first few of a world, or each one of a depth folder."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.depth_source import BadFrame
from cliffscan.services.capture.sources.replay import images_of, read_camera, read_depth
from experiments.frames import Frame

SLOWEST, FASTEST = 5.0, 30.0  # [Hz] of a replay: slow enough for a busy machine,
LAP = 10.0  # [s] but a round of a long recording shall not take much longer than this
LAPS = 3  # rounds without any new frame, after which the others are given up

Key = tuple[Camera, bytes]


class Aim(Protocol):
    """What all the processes are for."""

    unit: str  # what is counted
    total: int  # wanted
    patience: float  # [s] without a new one, after which it is of no use to go on

    @property
    def done(self) -> int:
        """How many of the wanted ones are there."""


class Goal(Aim, Protocol):
    """Frames to collect."""

    def take(self, frame: Frame) -> None:
        """Take in a complete frame, wanted or not."""


class FirstFrames:
    """The first `total` frames, whatever they show."""

    unit = "frames"
    patience = 30.0

    def __init__(self, total: int) -> None:
        self.total = total
        self.frames: list[Frame] = []

    @property
    def done(self) -> int:
        """How many frames are there."""
        return len(self.frames)

    def take(self, frame: Frame) -> None:
        """Keep the frame if there are not enough."""
        if self.done < self.total:
            self.frames.append(frame)


class EveryFrame:
    """Every good frame of a depth folder once, told apart by content: on a busy machine some come in a later round.

    The scans of all frames are kept, whole frames only for `pictures` of them, evenly chosen.
    Raises ConfigError where the folder cannot be used.
    """

    unit = "frames"

    def __init__(self, folder: Path, pictures: int) -> None:
        self.bad: list[str] = []  # why, of each frame that cannot be had
        self.scans: dict[str, dict[str, LaserScan]] = {}  # by the frame's name, then by path
        self.frames: dict[str, Frame] = {}  # those to be pictured, by name
        self._names: dict[Key, list[str]] = {}
        self._read(folder)
        good = sorted(name for names in self._names.values() for name in names)
        if not good:
            raise ConfigError(f"{folder}: no usable PNG in it; {'; '.join(self.bad[:3])}")
        self.total = len(good)
        self.rate = float(np.clip(self.total / LAP, SLOWEST, FASTEST))  # [Hz] at which to play the folder
        self.patience = LAPS * (self.total + len(self.bad)) / self.rate + 10.0
        chosen = np.linspace(0, len(good) - 1, min(pictures, len(good))).round().astype(int)
        self._pictured = {good[place] for place in chosen}

    @property
    def done(self) -> int:
        """How many frames have been seen."""
        return len(self.scans)

    @property
    def missing(self) -> list[str]:
        """The names of those that have not been seen."""
        return sorted(name for names in self._names.values() for name in names if name not in self.scans)

    def take(self, frame: Frame) -> None:
        """Keep the frame under the names that its images have in the folder."""
        for name in self._names.get(_key(frame.image.camera, frame.image.depth), []):
            self.scans[name] = frame.scans
            if name in self._pictured:
                self.frames[name] = frame

    def _read(self, folder: Path) -> None:
        file = read_camera(folder)
        for image in images_of(folder):
            try:
                camera = file.camera_of(image.stem)
                depth = read_depth(image, camera.width, camera.height)
            except BadFrame as error:
                self.bad.append(str(error))
            else:
                self._names.setdefault(_key(camera, depth), []).append(image.stem)


def _key(camera: Camera, depth: NDArray[np.uint16]) -> Key:
    return camera, hashlib.sha256(depth.tobytes()).digest()
