"""What ros2 would have published of the samples that are recorded, by the very functions that ros2 uses."""

from collections.abc import Callable
from functools import lru_cache
from typing import TypeVar

from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.topics import DEPTH, Topic
from cliffscan.common.runtime.decoder import Decoder
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.common.runtime.pace import Pace
from cliffscan.common.runtime.raw_samples import RawSample, key_matcher
from cliffscan.recording.mcap_file import RosTopic
from cliffscan.recording.recorded_clock import SECOND, was_set_back
from cliffscan.services.ros2.config import Ros2Config
from cliffscan.services.ros2.interfaces import Interface
from cliffscan.services.ros2.node import Profile
from cliffscan.services.ros2.outputs import feeds

M = TypeVar("M", bound=Message)
Receive = Callable[[str, bytes], object]


class RosView:
    """Turns samples into ROS messages, in the place of ros2's node and service (services/ros2/ports.py).

    write: takes each message with its topic.
    images: depth images a second [Hz] that are turned into images, at most; each costs as much as all the rest.
    """

    def __init__(self, robot: str, write: Callable[[RosTopic, bytes], None], images: float) -> None:
        self.config = Ros2Config.model_validate({})
        self.metrics = ServiceMetrics()
        self.bus = _Samples(robot)
        self._write = write
        self._image_period = SECOND / images if images else None
        self._next_image = 0.0
        for feed in feeds(self, self):
            feed.poll()

    def publisher(self, topic: str, interface: Interface, profile: Profile) -> "_Publisher":
        """A ROS topic in the recording."""
        return _Publisher(RosTopic(f"/{topic}", interface, profile), self._write)

    def receive_latched(self, topic: Topic[M], accept: Callable[[M], None]) -> None:
        """Call `accept` for every good message of `topic`."""
        decoder = Decoder(topic.message, self.metrics)

        def arrived(path: str, payload: bytes) -> None:
            message = decoder.decode(path, payload)
            if message is not None:
                accept(message)

        self.bus.subscribe(topic.path, arrived)

    def take(self, sample: RawSample) -> None:
        """Write what is made of a sample."""
        if was_set_back(self.bus.now, sample.received):
            self._next_image = 0.0
            self.bus.begin_paces_anew()
        self.bus.now = sample.received
        if sample.path == DEPTH.path and not self._image_due(sample.received):
            return
        for receive in self.bus.receivers(sample.path):
            receive(sample.path, sample.payload)

    def _image_due(self, now: int) -> bool:
        if self._image_period is None or now < self._next_image:
            return False
        self._next_image = now + self._image_period
        return True


class _Publisher:
    """A topic that is always wanted."""

    has_subscribers = True

    def __init__(self, topic: RosTopic, write: Callable[[RosTopic, bytes], None]) -> None:
        self._topic = topic
        self._write = write

    def put(self, payload: bytes) -> None:
        self._write(self._topic, payload)


class _Samples:
    """The samples as ros2's feeds subscribe to them."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.now = 0  # [ns] when the sample came that is taken
        self._receivers: list[tuple[Callable[[str], bool], Receive]] = []
        self._paces: list[Pace] = []
        self.receivers = lru_cache(1024)(self._find)

    def beside(self, robot: str) -> "_Samples":  # noqa: ARG002 - there is one robot
        return self

    def subscribe(
        self,
        path: str,
        receive: Receive,
        room: int = 1,
        rate: float | None = None,
        refused: Callable[[str, MessageError], object] | None = None,  # noqa: ARG002 - sizes are checked before
    ) -> None:
        """As of the bus, but what would wait for its turn is left out."""
        pace = Pace(rate, room) if rate else None
        if pace:
            self._paces.append(pace)

        def take(path: str, payload: bytes) -> None:
            now = self.now / SECOND
            if not pace:
                receive(path, payload)
            elif pace.delay(now) == 0.0:
                pace.spend(now)
                receive(path, payload)

        self._receivers.append((key_matcher([path]), take))

    def begin_paces_anew(self) -> None:
        """The clock was set back: what came before says nothing of how fast samples come now."""
        for pace in self._paces:
            pace.begin_anew()

    def retract(self) -> None:
        """Nothing is taken back: every topic is wanted for as long as the recording lasts."""

    def _find(self, path: str) -> list[Receive]:
        return [receive for matches, receive in self._receivers if matches(path)]
