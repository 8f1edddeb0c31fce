"""Depth frames of a camera, a recording or the simulator, each with its camera and floor plane."""

import logging
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace

from cliffscan.common.contract.camera import Camera
from cliffscan.common.runtime.service import PATIENCE, Service, main
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.depth_publisher import DepthPublisher
from cliffscan.services.capture.description import Description
from cliffscan.services.capture.floor.tracker import FloorTracker, tracker_of
from cliffscan.services.capture.region import RegionLearner
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame, Source, SourceEnded, SourceLost
from cliffscan.services.capture.sources.frozen import REPEATED, FrozenWatch
from cliffscan.services.capture.sources.kinds import KINDS
from cliffscan.services.capture.sources.open_source import open_source

BACK_OFF = (0.5, 8.0)  # [s] before the first and, doubled each time, before a later attempt to open a device

log = logging.getLogger(__name__)


def frames(service: Service[CaptureConfig], link: Callable[[], str] = str) -> Iterator[DepthFrame]:
    """Every good frame until the service or its source ends; a device that is lost is opened again.

    The service is ready, and its camera described, when a source has brought its first frame. link: what the status
    notes of the link.
    """
    description = Description(service)
    watch = None if KINDS[service.config.source].recorded else FrozenWatch(service.metrics)
    bounds = Bounds()
    delay = BACK_OFF[0]

    def standing() -> str:
        return "; ".join(filter(None, (bounds.note, link())))

    while service.running:
        try:
            with closing(open_source(service.config, service)) as source:
                seen = bounded(new_frames(source, service, watch), service, bounds)
                for frame in located(described(seen, service, description), service, standing):
                    delay = BACK_OFF[0]
                    yield frame
        except SourceLost as error:
            service.metrics.warn_limited("source_lost", f"{error}; trying again in {delay:g} s")
            service.waiting(str(error))
            service.pause(delay)
            delay = min(2 * delay, BACK_OFF[1])
        except SourceEnded:
            return


def new_frames(source: Source, service: Service[CaptureConfig], watch: FrozenWatch | None) -> Iterator[DepthFrame]:
    """The good frames of one source that the watch, where there is one, does not know yet. Raises SourceLost."""
    while service.running:
        try:
            frame = source.read(PATIENCE)
        except BadFrame as error:
            service.metrics.warn_limited("bad_frame", str(error))
            continue
        if not frame:
            continue
        if watch and not watch.is_new(frame.depth):
            service.note = REPEATED
            continue
        if service.note == REPEATED:
            service.note = ""
        yield frame


class Bounds:
    """The region that is learnt of a sensor, also while its device is opened again. note: which one it is, if any."""

    def __init__(self) -> None:
        self.note = ""
        self._learner = RegionLearner()

    def update(self, frame: DepthFrame) -> Camera:
        """The frame's camera with what has been learnt up to it."""
        region = self._learner.update(frame.depth)
        note = f"no return from any pixel outside the region: capture.region = {list(region)}" if region else ""
        if note != self.note:
            self.note = note
            log.info("%s", note or "a pixel outside the region returned something: all may")
        return replace(frame.camera, seen=region)


def bounded(frames: Iterator[DepthFrame], service: Service[CaptureConfig], bounds: Bounds) -> Iterator[DepthFrame]:
    """The frames of one source, each with the camera that is configured, and with the region that is learnt if none is.

    Raises ConfigError.
    """
    for frame in frames:
        camera = service.config.camera(frame.camera)
        configured = frame._replace(camera=camera)
        yield configured if camera.seen else configured._replace(camera=bounds.update(configured))


def described(
    frames: Iterator[DepthFrame], service: Service[CaptureConfig], description: Description
) -> Iterator[DepthFrame]:
    """The frames of one source; their camera is described, and with the first of them the service is ready."""
    for frame in frames:
        if service.state != "working":
            description.begin(frame)
            service.ready()
        description.follow(frame)
        yield frame


def located(
    frames: Iterator[DepthFrame], service: Service[CaptureConfig], standing: Callable[[], str] = str
) -> Iterator[DepthFrame]:
    """The frames of one source, each with the floor that is seen in it, or as they are where the floor is fixed.

    standing: what the status notes beside where the floor is.
    """
    tracker: FloorTracker | None = None
    for frame in frames:
        if service.config.floor == "fixed":
            service.note = standing()
            yield frame
            continue
        tracker = tracker_of(frame.camera.floor, tracker)
        floor = tracker.update(frame.depth, frame.camera)
        service.note = "; ".join(filter(None, (standing(), tracker.note)))
        if not tracker.measured:
            service.metrics.count("floor_kept")
        yield frame._replace(camera=replace(frame.camera, floor=floor))


def serve(service: Service[CaptureConfig]) -> None:
    """Publish every frame that the link carries."""
    publisher = DepthPublisher(service)
    for seq, frame in enumerate(frames(service, lambda: publisher.note)):
        publisher.put(seq, frame)


if __name__ == "__main__":
    main("capture", CaptureConfig, serve)
