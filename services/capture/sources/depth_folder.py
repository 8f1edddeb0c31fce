"""A depth folder: `camera.json` and one 16-bit PNG per frame, in order of name."""

from collections.abc import Iterator, Sequence
from functools import partial
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
from cliffscan.common.contract.description import Place, check_place
from cliffscan.common.contract.limits import LONGEST_PERIOD
from cliffscan.common.contract.message import Stamp, explain
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.depth_png import decode_depth
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.recorded import Origins, RecordedImage

Four = tuple[float, float, float, float]
LEVEL = (0.0, -1.0, 0.0, 0.3)  # a floor below any camera
CAMERA_FILE = "camera.json"


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
    place: tuple[float, float, float] | None = None  # x, y [m], yaw [rad] of the camera on the base
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

    def standing(self) -> Place | None:
        """Where the camera stands on the base, where that is said."""
        return Place(*self.place) if self.place else None

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


class DepthFolder:
    """A depth folder as a recording. Raises ConfigError where it cannot be used."""

    kind = "depth folder"

    def __init__(self, folder: Path) -> None:
        self._file = read_camera(folder)
        self._images = images_of(folder)
        self._stamps = recorded_stamps(folder, self._file, self._images)
        self._period = usual_step(self._stamps)
        self.stamped = bool(self._stamps)

    def __len__(self) -> int:
        return len(self._images)

    def images(self) -> Iterator[RecordedImage]:
        """The images in order of name."""
        stamps = self._stamps or [0] * len(self)
        return (
            RecordedImage(image.stem, partial(self._frame, image, stamp))
            for image, stamp in zip(self._images, stamps, strict=True)
        )

    def contents(self) -> list[str]:
        """What is in it, a line each."""
        stamps = "a stamp for each" if self.stamped else "no stamps: frames are stamped when they are played"
        own = {key for each in self._file.frames.values() for key in each.model_fields_set - {"stamp"}}
        return [f"{len(self)} PNGs", f"camera.json with {stamps}", *(f"frames with their own {key}" for key in own)]

    def origins(self) -> Origins:
        """camera.json, or a Kinect's where that says nothing."""
        noise = "by camera.json" if "noise" in self._file.model_fields_set else "a Kinect's: camera.json has none"
        file = "by camera.json"
        return Origins("millimetres, as in any depth folder", file, file, file, noise)

    def close(self) -> None:
        """Nothing is held."""

    def _frame(self, image: Path, stamp: int) -> DepthFrame:
        camera = self._file.camera_of(image.stem)
        depth = read_depth(image, camera.width, camera.height)
        return DepthFrame(depth, stamp, camera, self._period, self._file.standing())


def images_of(folder: Path) -> list[Path]:
    """The folder's PNGs, `.PNG` too, in order of name. Raises ConfigError where it has none."""
    images = sorted(each for each in folder.iterdir() if each.suffix.lower() == ".png")
    if not images:
        raise ConfigError(f"{folder}: no PNG in it")
    return images


def recorded_stamps(folder: Path, file: CameraFile, images: Sequence[Path]) -> list[int]:
    """The recorded stamp [ns] of each image; none where no image has one.

    Raises ConfigError where only some have: recorded and present times in one stream would send its consumers back and
    forth by years. And where two have the same: a consumer could not tell the two frames apart.
    """
    of_all = [(image.name, file.frames.get(image.stem, FrameOverride()).stamp) for image in images]
    bare = [name for name, stamp in of_all if stamp is None]
    if bare and len(bare) < len(of_all):
        raise ConfigError(
            f"{folder / CAMERA_FILE}: {len(bare)} of {len(of_all)} frames have no stamp, {bare[0]} first:"
            " give each frame one, or none"
        )
    named: dict[int, str] = {}
    for name, stamp in of_all:
        if stamp is None:
            continue
        if stamp in named:
            raise ConfigError(
                f"{folder / CAMERA_FILE}: {named[stamp]} and {name} have the same stamp, {stamp}:"
                " give each frame its own, or none any"
            )
        named[stamp] = name
    return list(named)


def usual_step(stamps: Sequence[int]) -> float | None:
    """The median time [s] between two stamps [ns] in a row, as much as a message can tell; None of fewer than two."""
    steps = [abs(after - before) * 1e-9 for before, after in pairwise(stamps)]
    return min(median(steps), LONGEST_PERIOD) if steps else None


def read_camera(folder: Path) -> CameraFile:
    """The folder's `camera.json`. Raises ConfigError, also where no frame can have such a camera or place."""
    path = folder / CAMERA_FILE
    try:
        file = CameraFile.model_validate_json(path.read_bytes())
        check_camera(file.camera(file.intrinsics, file.floor or LEVEL))
        if place := file.standing():
            check_place(place)
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
