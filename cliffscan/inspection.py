"""What the frames of a recording show, looked at once and from the first to the last."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.description import Place
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.floor_survey import FloorSurvey
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import BadFrame
from cliffscan.services.capture.sources.recorded import Recorded

Depth = NDArray[np.uint16]

LARGEST = 1 << 16  # [mm] beyond any depth
MEASURED = 300  # frames at most in which the floor is measured; of a longer recording they are spread evenly
TRIED = 5  # frames with which other units are tried
ENOUGH = 0.5  # share of the frames that have a floor where units and mount are right
OTHER_UNITS = (0.1, 0.2, 0.25, 10.0)  # [mm] in which depths are written by some


@dataclass
class Facts:
    """What was seen. stamps [ns] of the good frames; lost: of the others those that can be told apart, with the reason.

    missing: how many are not good. repeats: frames that equal the one before bit for bit.
    camera, place: the first frame's; None, and the configured one, where no frame is good.
    counts: how often each depth [mm] occurs in the frames that were measured.
    unit [mm]: in which the depths make a floor where they make none in millimetres.
    """

    place: Place
    camera: Camera | None = None
    stamps: list[int] = field(default_factory=list)
    lost: list[str] = field(default_factory=list)
    missing: int = 0
    repeats: int = 0
    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(LARGEST, np.int64))
    survey: FloorSurvey = field(default_factory=FloorSurvey)
    unit: float = 1.0


def inspect(recorded: Recorded, config: CaptureConfig, stop: StopSignal) -> Facts:
    """Look at all frames, or at those up to a stop. Raises ConfigError."""
    facts = Facts(config.place())
    some: list[tuple[Depth, Camera]] = []
    last: Depth | None = None
    step = max(1, -(-len(recorded) // MEASURED))
    for image in recorded.images():
        if stop.is_set():
            facts.missing = len(facts.lost)
            return facts
        try:
            frame = image.read()
        except BadFrame as error:
            facts.lost.append(f"{image.name}: {error}")
            continue
        camera = config.camera(frame.camera)
        if facts.camera is None:
            facts.camera, facts.place = camera, frame.place or facts.place
        if len(facts.stamps) % step == 0:
            facts.survey.add(frame.depth, camera)
            facts.counts += np.bincount(frame.depth.ravel(), minlength=LARGEST)
            some += [(frame.depth, camera)] if len(some) < TRIED else []
        facts.stamps.append(frame.stamp)
        facts.repeats += last is not None and bool(frame.depth.any()) and np.array_equal(last, frame.depth)
        last = frame.depth
    facts.missing = len(recorded) - len(facts.stamps)
    if facts.survey.seen < ENOUGH * facts.survey.frames:
        facts.unit = next((unit for unit in OTHER_UNITS if has_floor(some, unit)), 1.0)
    return facts


def has_floor(frames: list[tuple[Depth, Camera]], unit: float) -> bool:
    """Whether most of the frames have a floor near their mount if their depths are in units of `unit` [mm]."""
    survey = FloorSurvey()
    for depth, camera in frames:
        survey.add(np.minimum(depth * unit, LARGEST - 1).astype(np.uint16), replace(camera, seen=None))
    return survey.seen > ENOUGH * survey.frames
