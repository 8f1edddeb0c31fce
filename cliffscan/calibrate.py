"""`cliffscan calibrate`: measure how the camera is mounted and what its sensor is like, from the floor that it sees."""

import math
import sys
import time
from collections.abc import Iterator
from typing import NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.common.contract.limits import LEAST_NOISE
from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.messages import DepthImage, ServiceStatus
from cliffscan.common.contract.topics import DEPTH, STATUS
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import PATIENCE, StopSignal
from cliffscan.plain import plain
from cliffscan.services.capture.floor.noise import deviation, deviations
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.services.capture.region import RegionLearner

M = TypeVar("M", bound=Message)

FIRST = 5.0  # [s] in which a capture that works has sent a frame
ENOUGH = 0.5  # share of the frames in which floor must be seen
UNITS = np.array([1e3, 180 / math.pi, 180 / math.pi])  # [mm], [deg], [deg]
STILL = (5.0, 0.5, 0.5)  # [mm], [deg], [deg] by which frames of a camera at rest may differ: standard deviations


class NotMeasured(Exception):
    """The mount could not be measured; the text is one line that says why and what to do."""


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


class Measurement(NamedTuple):
    """A mount and a sensor. mounts: (n, 3) height [m], pitch and roll [rad] of the frames in which the floor was seen.

    region: what can carry a return, None where all pixels can.
    """

    mounts: NDArray[np.float64]
    noise: Noise
    region: Region | None
    frames: int  # that came
    residual: float  # [m] rms height of floor pixels
    share: float  # of the pixels that may have seen floor

    def lines(self) -> str:
        """The configuration, and as comments how good it is."""
        height, pitch, roll = np.median(self.mounts, axis=0) * UNITS
        scatter = np.std(self.mounts, axis=0) * UNITS
        return "\n".join(
            (
                "[capture]",
                f"height = {height / 1e3:.4f}  # [m]",
                f"pitch = {round(pitch, 2) + 0.0:.2f}  # [deg]",
                f"roll = {round(roll, 2) + 0.0:.2f}  # [deg]",
                f"noise = {self.noise.whole:.5f}  # [1/m] near {self.noise.near:.5f}, far {self.noise.far:.5f}",
                *([f"region = {list(self.region)}  # nothing outside it returned anything"] if self.region else []),
                f"# floor seen in {len(self.mounts)} of {self.frames} frames, on {self.share:.0%} of the pixels tried",
                f"# residual: {self.residual * 1e3:.1f} mm rms of the floor's heights",
                f"# scatter over the frames: {_in_words(scatter)}",
            )
        )


def calibrate(bus: Bus, seconds: float, nominal: FloorPlane | None, stop: StopSignal) -> int:
    """Print the mount as configuration, measured over `seconds` [s] of frames; 1 where that cannot be done.

    nominal: the mount to look around; None for that of the first frame.
    """
    try:
        print(measure(frames(bus, seconds, stop), nominal).lines())
    except NotMeasured as why:
        print(f"cliffscan: {plain(str(why))}", file=sys.stderr)
        return 1
    return 0


def frames(bus: Bus, seconds: float, stop: StopSignal) -> Iterator[DepthImage]:
    """The frames that capture sends within `seconds` [s] from the first. Raises NotMeasured where none comes."""
    queue: LatestQueue[bytes] = LatestQueue()
    words: LatestQueue[bytes] = LatestQueue()
    bus.subscribe(DEPTH.path, lambda _key, payload: queue.put(payload))
    bus.subscribe(STATUS.named("capture").path, lambda _key, payload: words.put(payload))
    received = False
    deadline = time.monotonic() + FIRST
    while time.monotonic() < deadline and not stop.is_set():
        payload = queue.get(PATIENCE)
        frame = _decoded(DepthImage, payload)
        if frame and not received:
            received, deadline = True, time.monotonic() + seconds
        if frame:
            yield frame
    if not received:
        status = _decoded(ServiceStatus, words.get(0.0))
        raise NotMeasured(f"no frame on {DEPTH.key(bus.robot)}: {_remedy(status)}")


def _remedy(status: ServiceStatus | None) -> str:
    """What to do where capture sends nothing, by its last word."""
    if status is None:
        return "capture does not run; start it with `cliffscan up` or `cliffscan run capture`"
    return f"capture is {status.state}{': ' if status.note else ''}{status.note}"


def measure(images: Iterator[DepthImage], nominal: FloorPlane | None) -> Measurement:
    """The mount and the sensor that the floor in the images shows. Raises NotMeasured.

    A person vouches for a floor without a hole, so one view is enough for the region.
    """
    tracker: FloorTracker | None = None
    seen: list[tuple[float, ...]] = []
    errors: list[NDArray[np.float64]] = []
    learner, region = RegionLearner(views=1), None
    total = 0
    for image in images:
        total += 1
        depth = image.depth
        region = learner.update(depth)
        tracker = tracker or FloorTracker(nominal or image.camera.floor)
        floor = tracker.update(depth, image.camera)
        if tracker.measured:
            seen.append((*floor.mount(), tracker.residual, tracker.share))
            errors.append(deviations(depth, image.camera, floor))
    if tracker is None or len(seen) < ENOUGH * total:
        why = f": {tracker.note}" if tracker and tracker.note else ""
        raise NotMeasured(f"floor seen in {len(seen)} of {total} frames{why}; show the camera level, empty floor")
    table = np.array(seen)
    noise = Noise.of(errors)
    measurement = Measurement(
        table[:, :3], noise, region, total, *(float(each) for each in np.median(table[:, 3:], axis=0))
    )
    _check_still(measurement)
    return measurement


def _check_still(measurement: Measurement) -> None:
    scatter = np.std(measurement.mounts, axis=0) * UNITS
    if (scatter > STILL).any():
        raise NotMeasured(f"the floor moved ({_in_words(scatter)}): keep the robot still on level floor")


def _in_words(deviations: NDArray[np.float64]) -> str:
    """Standard deviations in UNITS."""
    height, pitch, roll = deviations
    return f"height {height:.2f} mm, pitch {pitch:.3f} deg, roll {roll:.3f} deg"


def _decoded(kind: type[M], payload: bytes | None) -> M | None:
    """The message, or None where there is none or a malformed one: the services count and log those."""
    try:
        return kind.decode(payload) if payload else None
    except MessageError:
        return None
