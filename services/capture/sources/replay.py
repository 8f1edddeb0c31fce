"""Depth frames from a folder: `camera.json` and one 16-bit PNG per frame, played in order of name."""

import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from cliffscan.common.contract.camera import (
    KINECT_BASELINE,
    KINECT_NOISE,
    Camera,
    FloorPlane,
    Intrinsics,
    Region,
    check_camera,
)
from cliffscan.common.contract.message import Stamp, explain
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_png import decode_depth
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame, Source, SourceEnded

Four = tuple[float, float, float, float]
LEVEL = (0.0, -1.0, 0.0, 0.3)  # a floor below any camera
LONGEST_PERIOD = 1e4  # [s] that a message can tell


class FrameOverride(BaseModel):
    """What one frame has different from the rest of its folder."""

    model_config = ConfigDict(strict=True, allow_inf_nan=False)

    stamp: Stamp | None = None  # [ns]
    intrinsics: Four | None = None  # fx, fy, cx, cy [px]
    floor: Four | None = None  # nx, ny, nz, d [m]


class CameraFile(FrameOverride):
    """`camera.json`: the camera of all frames, and what single frames have different."""

    width: int
    height: int
    intrinsics: Four
    range: tuple[float, float]  # [m]
    noise: float = KINECT_NOISE  # [1/m] of the inverse depth
    baseline: float = KINECT_BASELINE  # [m]
    region: tuple[int, int, int, int] | None = None  # that can carry a return
    frames: Annotated[dict[str, FrameOverride], Field(default_factory=dict)]

    def camera_of(self, frame: str) -> Camera:
        """The camera as it was for one frame. Raises BadFrame where that cannot be."""
        override = self.frames.get(frame, FrameOverride())
        floor = override.floor or self.floor
        if floor is None:
            raise BadFrame(f"{frame}: camera.json has no floor for it")
        camera = self.camera(override.intrinsics or self.intrinsics, floor)
        try:
            check_camera(camera)
        except ValueError as error:
            raise BadFrame(f"{frame}: camera.json: {error}") from error
        return camera

    def camera(self, intrinsics: Four, floor: Four) -> Camera:
        """A camera of this folder with these intrinsics and floor, possible or not."""
        return Camera(
            self.width,
            self.height,
            Intrinsics(*intrinsics),
            self.range,
            FloorPlane(*floor),
            self.noise,
            self.baseline,
            Region.part(self.region, self.width, self.height),
        )


class Replay:
    """Plays a depth folder at `rate` [Hz], once or in a loop.

    Frames are stamped when they are played, unless camera.json has a stamp for each; then a second round goes on from
    the last stamp of the first. Raises ConfigError where the folder cannot be used.
    """

    def __init__(self, folder: Path, rate: float, loop: bool) -> None:
        self._file = read_camera(folder)
        self._images = images_of(folder)
        self._stamps = recorded_stamps(folder, self._file, self._images)
        self._recorded_period = usual_step(self._stamps)
        self._period = 1.0 / rate
        self._loop = loop
        self._next = 0
        self._due = time.monotonic()

    def read(self, timeout: float) -> DepthFrame | None:
        """The next frame when its time has come."""
        round_, place = divmod(self._next, len(self._images))
        if round_ and not self._loop:
            raise SourceEnded
        wait = self._due - time.monotonic()
        time.sleep(min(max(wait, 0.0), timeout))
        if wait > timeout:
            return None
        self._next += 1
        self._due = max(self._due + self._period, time.monotonic())
        image = self._images[place]
        camera = self._file.camera_of(image.stem)
        depth = read_depth(image, camera.width, camera.height)
        return DepthFrame(depth, self._stamp(place, round_), camera, self._recorded_period)

    def close(self) -> None:
        """Nothing is held."""

    def _stamp(self, place: int, round_: int) -> int:
        if not self._stamps:
            return time.time_ns()
        lap = max(self._stamps) - min(self._stamps) + round((self._recorded_period or self._period) * 1e9)
        return self._stamps[place] + round_ * lap


def open_configured(config: CaptureConfig) -> Source:
    """The depth folder, bag or MCAP file that is configured. Raises ConfigError."""
    path = Path(config.path)
    if path.is_file() or (path / "metadata.yaml").is_file():
        from cliffscan.services.capture.sources.bag import BagReplay  # a depth folder needs no rosbags

        return BagReplay(path, config)
    return Replay(path, config.rate, config.loop)


def images_of(folder: Path) -> list[Path]:
    """The folder's PNGs, `.PNG` too, in order of name. Raises ConfigError where it has none."""
    images = sorted(each for each in folder.iterdir() if each.suffix.lower() == ".png")
    if not images:
        raise ConfigError(f"{folder}: no PNG in it")
    return images


def recorded_stamps(folder: Path, file: CameraFile, images: Sequence[Path]) -> list[int]:
    """The recorded stamp [ns] of each image; none where no image has one. Raises ConfigError where only some have.

    Recorded and present times in one stream would send its consumers back and forth by years.
    """
    of_all = {image.stem: file.frames.get(image.stem, FrameOverride()).stamp for image in images}
    bare = [name for name, stamp in of_all.items() if stamp is None]
    if bare and len(bare) < len(of_all):
        raise ConfigError(
            f"{folder / 'camera.json'}: {len(bare)} of {len(of_all)} frames have no stamp, {bare[0]} first:"
            " give each frame one, or none"
        )
    return [stamp for stamp in of_all.values() if stamp is not None]


def usual_step(stamps: Sequence[int]) -> float | None:
    """The median time [s] between two stamps [ns] in a row, as much as a message can tell; None of fewer than two."""
    steps = [abs(after - before) * 1e-9 for before, after in pairwise(stamps)]
    return min(median(steps), LONGEST_PERIOD) if steps else None


def read_camera(folder: Path) -> CameraFile:
    """The folder's `camera.json`. Raises ConfigError, also where no frame can have such a camera."""
    path = folder / "camera.json"
    try:
        file = CameraFile.model_validate_json(path.read_bytes())
        check_camera(file.camera(file.intrinsics, file.floor or LEVEL))
        return file
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from error
    except ValidationError as error:
        raise ConfigError(f"{path}: {explain(error)}") from error
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from error


def read_depth(path: Path, width: int, height: int) -> NDArray[np.uint16]:
    """A 16-bit greyscale PNG as (height, width) [mm]. Raises BadFrame where it is anything else."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadFrame(f"{path.name}: {error}") from error
    return decode_depth(content, path.name, width, height)
