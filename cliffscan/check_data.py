"""`cliffscan check-data`: what is in a recording, what is assumed of it, and what a robot would suffer from."""

import math
from collections.abc import Iterator
from contextlib import closing
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.floor_survey import UNITS
from cliffscan.inspection import ENOUGH, Facts, inspect
from cliffscan.plain import plain
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_folder import usual_step
from cliffscan.services.capture.sources.recorded import Recorded
from cliffscan.services.capture.sources.replay import open_recorded

SPARSE = 0.05  # share of pixels with a return; before a floor a camera has more
WITHIN = 0.1  # share of the returns within the sensor's range; of a hall, too, more is within it
OFF = (26.0, 2.0, 2.0)  # [mm], [deg], [deg] by which a mount is wrong: a tape and an eye do better
NOISIER = 2.0  # times as noisy as assumed, and floor may look like edges
OFF_CENTRE = 0.15  # of the image's side, by which a principal point is beside the middle
PAUSE, PAUSES = 0.5, 3.0  # [s], and usual periods, without a frame: a robot has stopped
UNEQUAL = 0.1  # relative difference of two focal lengths
SETTING = "in camera.json, by /tf_static, or by --set capture.height, capture.pitch and capture.roll"


def check_data(path: Path, config: CaptureConfig, stop: StopSignal) -> int:
    """Print what is in a recording; 1 where something is wrong with it."""
    try:
        with closing(open_recorded(config)) as recorded:
            print(plain(f"{path}: {recorded.kind}, {len(recorded)} depth images"))
            facts = inspect(recorded, config, stop)
            for line in described(recorded, facts):
                print(plain(line))
            for note in notes(facts, recorded.stamped):
                print(f"note: {plain(note)}")
            found = list(wrongs(facts, recorded.stamped))
    except ConfigError as error:
        found = [str(error)]
    for wrong in found:
        print(f"wrong: {plain(wrong)}")
    if not found:
        print("nothing is wrong")
    return 1 if found else 0


def described(recorded: Recorded, facts: Facts) -> Iterator[str]:
    """What is in it, what is assumed, and what was measured, a line each."""
    for line in recorded.contents():
        yield f"contents: {line}"
    camera = facts.camera
    if camera is None:
        return
    origins = recorded.origins()
    (fx, fy, cx, cy), (near, far), place = camera.intrinsics, camera.range, facts.place
    yield f"times: {times(facts.stamps) if recorded.stamped else 'those of the replay'}"
    yield f"depths: {camera.width}x{camera.height}, {depths(facts.counts)}"
    yield f"units: {origins.units}"
    yield f"intrinsics: fx {fx:.1f}, fy {fy:.1f}, cx {cx:.1f}, cy {cy:.1f} px, {origins.intrinsics}"
    yield f"range: {near:g} to {far:g} m, {origins.range}"
    yield f"mount: {mount(np.array(camera.floor.mount()))}, {origins.mount}"
    yield f"place on the base: x {place.x:.3f} m, y {place.y:.3f} m, yaw {math.degrees(place.yaw):.1f} deg"
    yield f"noise: {camera.noise:.5f} 1/m, {origins.noise}"
    yield f"region: {region(camera, facts)}"
    yield f"measured floor: {floor(facts)}"
    if facts.survey.seen:
        yield f"measured noise: {facts.survey.noise().whole:.5f} 1/m about the floor"


def times(stamps: list[int]) -> str:
    """How long, how often, and the longest pause."""
    step = usual_step(stamps)
    if not step:
        return f"one stamp, {stamps[0]} ns"
    return f"{(max(stamps) - min(stamps)) * 1e-9:.2f} s, {1 / step:.1f} Hz, longest pause {longest_pause(stamps):.2f} s"


def longest_pause(stamps: list[int]) -> float:
    """The longest time [s] between two stamps [ns] in a row."""
    return max(after - before for before, after in pairwise(stamps)) * 1e-9


def depths(counts: NDArray[np.int64]) -> str:
    """How many pixels return something, and from how far."""
    total, returns = counts.sum(), counts[1:].sum()
    if not returns:
        return "no pixel returns anything"
    low, middle, high = np.searchsorted(np.cumsum(counts[1:]), np.array([0.01, 0.5, 0.99]) * returns) + 1
    return f"{returns / total:.0%} of the pixels return something, from {low} to {high} mm, the median is {middle} mm"


def mount(each: NDArray[np.float64]) -> str:
    """Height [m], pitch and roll [rad] in words."""
    millimetres, pitch, roll = np.round(each * UNITS, 2) + 0.0
    return f"{millimetres / 1e3:.3f} m high, {pitch:.1f} deg down, rolled {roll:.1f} deg"


def region(camera: Camera, facts: Facts) -> str:
    """Which pixels can carry a return."""
    if camera.seen:
        return f"{list(camera.seen)}, as given"
    learnt = facts.survey.region
    return f"{list(learnt)}, for nothing outside it returned anything" if learnt else "all pixels"


def floor(facts: Facts) -> str:
    """Where the floor was seen."""
    survey = facts.survey
    seen = f"seen in {survey.seen} of {survey.frames} frames"
    if not survey.seen:
        return seen
    residual, share = survey.fit()
    where = mount(np.median(survey.mounts(), axis=0))
    millimetres, pitch, roll = np.median(survey.errors(), axis=0) * UNITS
    off = f"off the mount by {millimetres:.0f} mm, {pitch:.1f} deg, {roll:.1f} deg"
    return f"{seen}, {where}, {off}; {1e3 * residual:.1f} mm rms of its heights on {share:.0%} of the pixels tried"


def wrongs(facts: Facts, stamped: bool) -> Iterator[str]:
    """What a robot would suffer from, each with its remedy."""
    if facts.lost:
        total = facts.missing + len(facts.stamps)
        yield f"{facts.missing} of {total} images are lost to a robot; {facts.lost[0]}"
    if facts.camera is None:
        yield "no image can be used: mend what is above, or record again"
        return
    yield from wrong_stream(facts, stamped)
    yield from wrong_camera(facts.camera)
    yield from wrong_depths(facts.camera, facts.counts)
    yield from wrong_floor(facts)


def wrong_stream(facts: Facts, stamped: bool) -> Iterator[str]:
    """Pictures and stamps that come again."""
    if facts.repeats:
        yield (
            f"{facts.repeats} frames repeat the one before bit for bit, and a live camera that does so counts as hung:"
            " restart its driver, or give a simulated camera noise"
        )
    back = sum(after <= before for before, after in pairwise(facts.stamps)) if stamped else 0
    if back:
        yield f"{back} stamps are not later than the one before: record one camera, with a clock that is not set"


def wrong_camera(camera: Camera) -> Iterator[str]:
    """Intrinsics that are hardly this image's."""
    (fx, fy, cx, cy), sides = camera.intrinsics, (camera.width, camera.height)
    if any(abs(c / side - 0.5) > OFF_CENTRE for c, side in zip((cx, cy), sides, strict=True)):
        yield (
            f"the principal point ({cx:.0f}, {cy:.0f}) is far from the middle of {sides[0]}x{sides[1]} pixels:"
            " give the intrinsics of this very image, not of a larger one"
        )
    if abs(fx / fy - 1.0) > UNEQUAL:
        yield f"the focal lengths {fx:.0f} and {fy:.0f} px differ: give an image that is not stretched"


def wrong_depths(camera: Camera, counts: NDArray[np.int64]) -> Iterator[str]:
    """Hardly any returns, or hardly any that the sensor can have measured."""
    total, returns = int(counts.sum()), int(counts[1:].sum())
    if returns < SPARSE * total:
        yield f"{returns / total:.1%} of the pixels return something: uncover the camera, or take its own depth topic"
        return
    near, far = (round(1e3 * each) for each in camera.range)
    within = int(counts[max(near, 1) : far + 1].sum()) / returns
    if within < WITHIN:
        yield (
            f"{within:.0%} of the returns lie within {camera.range[0]:g} to {camera.range[1]:g} m: set the sensor's"
            " range (capture.range, or range in camera.json), or write the depths in millimetres"
        )


def wrong_floor(facts: Facts) -> Iterator[str]:
    """A floor that is not there, or not where the mount has it."""
    survey = facts.survey
    if facts.unit != 1.0:
        yield f"the depths make a floor if their unit is {facts.unit:g} mm: write them in millimetres"
    elif survey.seen < ENOUGH * survey.frames:
        yield (
            f"the floor is seen in {survey.seen} of {survey.frames} frames near its mount: show the camera the floor"
            f" before the robot, and give the mount within 5 deg and 5 cm, {SETTING}"
        )
    if survey.seen:
        off = np.median(survey.errors(), axis=0)
        if (np.abs(off * UNITS) > OFF).any():
            right = mount(np.median(survey.mounts(), axis=0))
            yield (
                f"the mount is wrong by {off[0] * 100:.1f} cm, {math.degrees(off[1]):.1f} deg down and"
                f" {math.degrees(off[2]):.1f} deg of roll: give {right}, {SETTING}"
            )


def notes(facts: Facts, stamped: bool) -> Iterator[str]:
    """What may be as it is, but is worth a look."""
    step = usual_step(facts.stamps) if stamped else None
    if step and longest_pause(facts.stamps) > max(PAUSE, PAUSES * step):
        yield (
            f"no frame for {longest_pause(facts.stamps):.1f} s: a live robot stops meanwhile; look for lost messages if"
            " nobody paused the recording"
        )
    if facts.camera and facts.survey.seen:
        measured, assumed = facts.survey.noise().whole, facts.camera.noise
        if measured > NOISIER * assumed:
            yield (
                f"the depths lie {measured / assumed:.1f} times as far off the floor's plane as the noise assumed:"
                f" where the floor is even, set capture.noise to {measured:.5f}, or noise in camera.json"
            )
