"""`cliffscan convert`: a recording as a depth folder, whose replay gives the same frames bit by bit."""

import json
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

from PIL import Image

from cliffscan.common.contract.camera import Camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.plain import plain
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_folder import CAMERA_FILE
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.recorded import Recorded
from cliffscan.services.capture.sources.replay import open_recorded


def convert(config: CaptureConfig, folder: Path, every: int, stop: StopSignal) -> int:
    """Write each `every`-th frame of the configured recording into an empty or new folder. Raises ConfigError.

    A frame that cannot be used is left out with a line. A stop ends the folder with the frame that is being written.
    """
    with closing(open_recorded(config)) as recorded:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if any(folder.iterdir()):
                raise ConfigError(f"{folder} is not empty: name a new folder")
            written = write(recorded, config, folder, every, stop)
        except OSError as error:
            raise ConfigError(f"{folder}: {error.strerror or error}") from error
    print(plain(f"{folder}: {written} of {len(recorded)} images"))
    return 0


def write(recorded: Recorded, config: CaptureConfig, folder: Path, every: int, stop: StopSignal) -> int:
    """The PNGs, and then camera.json; how many PNGs. Raises ConfigError where there is none, OSError."""
    told: dict[str, Any] = {}
    frames: dict[str, dict[str, Any]] = {}
    for number, image in enumerate(recorded.images()):
        if stop.is_set():
            break
        if number % every:
            continue
        try:
            frame = image.read()
        except BadFrame as error:
            print(plain(f"leaving out {image.name}: {error}"), file=sys.stderr)
            continue
        told = told or whole(frame, config.camera(frame.camera))
        frames[image.name] = own(frame, told, recorded.stamped)
        Image.fromarray(frame.depth).save(folder / f"{image.name}.png", "PNG")
    if not frames:
        raise ConfigError("no image can be used, so nothing was written; `cliffscan check-data` says why")
    (folder / CAMERA_FILE).write_text(json.dumps(told | {"frames": frames}, indent=1) + "\n")
    return len(frames)


def whole(frame: DepthFrame, camera: Camera) -> dict[str, Any]:
    """What camera.json says of all frames."""
    told: dict[str, Any] = {
        "width": camera.width,
        "height": camera.height,
        "intrinsics": list(camera.intrinsics),
        "range": list(camera.range),
        "floor": list(camera.floor),
        "noise": camera.noise,
        "baseline": camera.baseline,
    }
    if camera.seen:
        told["region"] = list(camera.seen)
    if frame.place:
        told["place"] = list(frame.place)
    return told


def own(frame: DepthFrame, told: dict[str, Any], stamped: bool) -> dict[str, Any]:
    """What one frame has beside or instead of that."""
    each = {"intrinsics": list(frame.camera.intrinsics), "floor": list(frame.camera.floor)}
    changed: dict[str, Any] = {key: value for key, value in each.items() if value != told[key]}
    return changed | ({"stamp": frame.stamp} if stamped else {})
