"""Publishes depth frames, as many and as large as the link to those that answer them carries."""

import math
import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.depth_codec import FAST, LEVELS, RAW, SMALL
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.service import Service
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import DepthFrame
from cliffscan.services.capture.thinning import thinned
from cliffscan.services.capture.window import Size, Window

PERCEPTION = "perception"  # the service whose token tells that a workstation perceives, too
THIN = "the link is thin: depth images have the rows that matter and one of {} columns"


class Stream:
    """One key of depth images, and the window that the fused scans which answer them open."""

    def __init__(
        self, service: Service[CaptureConfig], depth: Topic[DepthImage], fused: Topic[LaserScan], period: float
    ) -> None:
        self.publisher = service.publisher(depth)
        self._window = Window(period) if service.config.fit_link else None
        if self._window:
            service.receive(fused, self._answered)

    @property
    def size(self) -> Size:
        """How much of a frame its images have."""
        return self._window.size if self._window else Size.FULL

    def admit(self, seq: int) -> Size | None:
        """How much of a frame goes; None where it is held back."""
        return self._window.admit(seq, time.monotonic()) if self._window else Size.FULL

    def _answered(self, scan: LaserScan) -> None:
        if self._window:
            self._window.answer(scan.seq, time.monotonic())


class DepthPublisher:
    """Publishes on camera/depth, and beside it for a workstation that perceives for a robot which does so too.

    Then the robot's own perception gets every frame whole, and the workstation what its link carries.
    """

    def __init__(self, service: Service[CaptureConfig]) -> None:
        config = service.config
        self._metrics = service.metrics
        self._frame = config.frame
        self._encoding = LEVELS if config.compressed else RAW
        self._period = 1.0 / config.rate  # [s] where a frame does not say its own
        self._height = math.inf  # [m] of the robot, above which nothing matters; not known
        self._all = Stream(service, topics.DEPTH, topics.SCAN_FUSED, self._period)
        of_workstation = topics.at_workstation(topics.DEPTH), topics.at_workstation(topics.SCAN_FUSED)
        self._workstation = Stream(service, *of_workstation, self._period)
        self._is_served = False  # a perception works there
        service.bus.beside(f"{service.bus.robot}/{topics.WORKSTATION}").watch_alive(self._changed)
        self._describe = service.bus.latch(topics.at_workstation(topics.DESCRIPTION))
        service.receive_latched(topics.DESCRIPTION, self._described)

    @property
    def note(self) -> str:
        """What a person should know of the link."""
        every = max(stream.size.value for stream in (self._all, self._workstation))
        return THIN.format(every) if every > 1 else ""

    def put(self, seq: int, frame: DepthFrame) -> None:
        """Publish a frame, or hold it back."""
        whole = {self._all: Size.FULL if self._is_served else self._all.admit(seq)}
        sizes = whole | ({self._workstation: self._workstation.admit(seq)} if self._is_served else {})
        images = {size: self._image(seq, frame, size) for size in {*sizes.values()} if size}
        for stream, size in sizes.items():
            if size:
                stream.publisher.put(images[size])
            else:
                self._metrics.count("held_back")
        if sizes[self._all]:
            self._metrics.output(frame.stamp)

    def _changed(self, service: str, alive: bool) -> None:
        """A subscriber alone tells nothing: a recorder and a fleet's perception receive all keys."""
        if service == PERCEPTION:
            self._is_served = alive

    def _image(self, seq: int, frame: DepthFrame, size: Size) -> DepthImage:
        depth, camera, effort = frame.depth, frame.camera, FAST
        if size is not Size.FULL:
            depth, camera = thinned(depth, camera, size.value, self._height)
            effort = SMALL
        period = self._period if frame.period is None else frame.period
        return DepthImage.pack(seq, frame.stamp, self._frame, depth, camera, self._encoding, period, effort)

    def _described(self, description: RobotDescription) -> None:
        """The base described its body, or a camera was."""
        if description.body:
            self._describe(description)
            if description.body.height is not None:
                self._height = description.body.height
