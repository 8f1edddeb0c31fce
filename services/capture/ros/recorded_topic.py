"""The images of one depth topic of a recording, whoever recorded it."""

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from functools import partial

from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.bag import IMAGES, Bag, Sample
from cliffscan.services.capture.ros.camera import RosCamera
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame
from cliffscan.services.capture.sources.recorded import Origins, RecordedImage


class RecordedTopic(ABC):
    """One of the depth topics `found` in a bag, the one that is configured. Raises ConfigError where there is none."""

    stamped = True

    def __init__(self, bag: Bag, config: CaptureConfig, kind: str, found: Collection[str]) -> None:
        self._bag, self._config = bag, config
        self.kind, self.contents = kind, bag.contents
        self._topic = bag.depth_topic(config.topic, sorted(found))
        self._connections = bag.of(self._topic, *IMAGES)
        self.camera = RosCamera(config, self._topic)

    def __len__(self) -> int:
        return sum(each.msgcount for each in self._connections)

    def images(self) -> Iterator[RecordedImage]:
        """The images in the order in which they were recorded, by their number."""
        self.camera.restart()
        for count, sample in enumerate(self._bag.samples(self._connections)):
            yield RecordedImage(f"{count:06}", partial(self._frame, sample))

    def close(self) -> None:
        """Close the file."""
        self._bag.close()

    @abstractmethod
    def origins(self) -> Origins:
        """Where units, intrinsics, range, mount and noise come from."""

    @abstractmethod
    def _frame(self, sample: Sample | BadFrame) -> DepthFrame:
        """The frame in a sample. Raises BadFrame."""
