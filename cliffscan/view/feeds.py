"""Topics of one robot, each received only while somebody listens, and decoded only once for all who do."""

import threading
import time
from collections.abc import Callable
from functools import cached_property
from typing import Any, Generic, TypeVar

from cliffscan.common.contract.message import Message, MessageError, unpack
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.metrics import ServiceMetrics

M = TypeVar("M", bound=Message)

RATE = 200.0  # [Hz] at which samples of a topic are looked at
ROOM = 8  # samples that may wait until then


class Sample(Generic[M]):
    """A payload, the path it came at, and when [s] by the steady clock."""

    def __init__(self, topic: Topic[M], path: str, payload: bytes) -> None:
        self.path = path
        self.at = time.monotonic()
        self._topic = topic
        self._payload = payload

    @cached_property
    def fields(self) -> dict[str, Any]:
        """Its fields, not checked yet. Raises MessageError."""
        return unpack(self._payload, self._topic.message.most_bytes())

    @cached_property
    def message(self) -> M:
        """What it says, decoded when somebody wants to know. Raises MessageError."""
        return self._topic.message.of(self.fields)


Receive = Callable[[Sample[Any]], object]


class Feed:
    """One topic and who listens to it."""

    def __init__(self, bus: Bus, topic: Topic[Any], metrics: ServiceMetrics) -> None:
        self._bus, self._topic, self._metrics = bus, topic, metrics
        self._listeners: list[Receive] = []
        self._lock = threading.Lock()

    def listen(self, receive: Receive) -> Callable[[], None]:
        """Call `receive` for every sample, from a thread of the topic's own, until what is returned is called."""
        with self._lock:
            self._listeners = [*self._listeners, receive]
            if len(self._listeners) == 1:
                self._subscribe()
        return lambda: self._leave(receive)

    def _leave(self, receive: Receive) -> None:
        with self._lock:
            self._listeners = [each for each in self._listeners if each is not receive]
            if not self._listeners:
                self._bus.retract()

    def _subscribe(self) -> None:
        if self._topic.latched:
            self._bus.receive_latched(self._topic.path, self._arrived)
        else:
            self._bus.subscribe(self._topic.path, self._arrived, ROOM, RATE, self._refused)

    def _arrived(self, path: str, payload: bytes) -> None:
        sample = Sample(self._topic, path, payload)
        for receive in self._listeners:
            try:
                receive(sample)
            except MessageError as error:
                self._refused(path, error)

    def _refused(self, path: str, why: MessageError) -> None:
        self._metrics.warn_limited("malformed", f"{path}: {why}")


class Feeds:
    """All topics of one robot."""

    def __init__(self, bus: Bus, robot: str) -> None:
        self.robot = robot
        self._bus = bus
        self._metrics = ServiceMetrics()
        self._feeds: dict[Topic[Any], Feed] = {}
        self._lock = threading.Lock()

    def listen(self, topic: Topic[M], receive: Callable[[Sample[M]], object]) -> Callable[[], None]:
        """Call `receive` for every sample of a topic until what is returned is called."""
        with self._lock:
            feed = self._feeds.setdefault(topic, Feed(self._bus.beside(self.robot), topic, self._metrics))
        return feed.listen(receive)
