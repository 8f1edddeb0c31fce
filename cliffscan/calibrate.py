"""`cliffscan calibrate`: measure how the camera is mounted and what its sensor is like, from the floor that it sees."""

import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.messages import DepthImage, ServiceStatus
from cliffscan.common.contract.topics import DEPTH, STATUS
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import PATIENCE
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.floor_survey import UNITS, FloorSurvey, Noise
from cliffscan.plain import plain

M = TypeVar("M", bound=Message)

FIRST = 5.0  # [s] in which a capture that works has sent a frame
ENOUGH = 0.5  # share of the frames in which floor must be seen
STILL = (5.0, 0.5, 0.5)  # [mm], [deg], [deg] by which frames of a camera at rest may differ: standard deviations


class NotMeasured(Exception):
    """The mount could not be measured; the text is one line that says why and what to do."""


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
    survey = FloorSurvey(views=1)
    for image in images:
        nominal = nominal or image.camera.floor
        survey.add(image.depth, replace(image.camera, floor=nominal))
    if not survey.frames or survey.seen < ENOUGH * survey.frames:
        why = f": {survey.note}" if survey.note else ""
        raise NotMeasured(
            f"floor seen in {survey.seen} of {survey.frames} frames{why}; show the camera level, empty floor"
        )
    measurement = Measurement(survey.mounts(), survey.noise(), survey.region, survey.frames, *survey.fit())
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
