"""A topic of the robot that travels to this process only while somebody in ROS subscribes to what is made of it."""

from collections.abc import Callable, Sequence
from typing import Any, Generic, TypeVar

from cliffscan.common.contract.message import Message
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.decoder import Decoder
from cliffscan.common.runtime.service import RATE, ROOM
from cliffscan.services.ros2.cdr import CdrError
from cliffscan.services.ros2.ports import Publisher, Service

M = TypeVar("M", bound=Message)
T = TypeVar("T")


class Output(Generic[T]):
    """A ROS topic, and how its message is made of one of ours, or None of one that makes none."""

    def __init__(self, publisher: Publisher, convert: Callable[[T], bytes | None]) -> None:
        self._publisher = publisher
        self._convert = convert

    @property
    def wanted(self) -> bool:
        """Whether anybody would receive it."""
        return self._publisher.has_subscribers

    def publish(self, message: T) -> None:
        """Convert a message and publish it, if anybody would receive it. Raises CdrError."""
        if self.wanted:
            payload = self._convert(message)
            if payload is not None:
                self._publisher.put(payload)


class Feed(Generic[M]):
    """Receives `topic` while an output is wanted, and hands each good message to `accept`.

    room: how many messages may wait; the oldest is dropped first. rate [Hz]: at which they are looked at, at most.
    """

    def __init__(
        self,
        service: Service[Any],
        topic: Topic[M],
        outputs: Sequence[Output[Any]],
        accept: Callable[[M], object] | None = None,
        room: int = ROOM,
        rate: float = RATE,
    ) -> None:
        self._bus = service.bus.beside(service.bus.robot)
        self._metrics = service.metrics
        self._topic = topic
        self._outputs = outputs
        self._accept = accept or self.publish
        self._room = room
        self._rate = rate
        self._receiving = False

    def publish(self, message: object) -> None:
        """Publish what every output makes of a message, or of what `accept` made of one."""
        for output in self._outputs:
            try:
                output.publish(message)
            except CdrError as error:
                self._metrics.warn_limited("malformed", f"{self._topic.path}: {error}")

    def poll(self) -> None:
        """Subscribe or take the subscription back, as the outputs are wanted; to be called some times a second."""
        wanted = any(output.wanted for output in self._outputs)
        if wanted and not self._receiving:
            self._subscribe()
        elif self._receiving and not wanted:
            self._bus.retract()
        self._receiving = wanted

    def _subscribe(self) -> None:
        decoder = Decoder(self._topic.message, self._metrics)

        def arrived(path: str, payload: bytes) -> None:
            message = decoder.decode(path, payload)
            if message is not None:
                self._accept(message)

        self._bus.subscribe(self._topic.path, arrived, self._room, self._rate, decoder.refused)
