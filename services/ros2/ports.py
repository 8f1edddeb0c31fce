"""What the outputs need around them: a service and a node of the runtime, or a recording in their place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

from cliffscan.common.contract.message import Message, MessageError
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.metrics import ServiceMetrics
from cliffscan.services.ros2.interfaces import Interface
from cliffscan.services.ros2.node import Profile

C_co = TypeVar("C_co", covariant=True)
M = TypeVar("M", bound=Message)


class Samples(Protocol):
    """The samples of a robot's keys, as the bus delivers them."""

    robot: str

    def beside(self, robot: str) -> Samples:
        """The same, to be retracted alone."""

    def subscribe(
        self,
        path: str,
        receive: Callable[[str, bytes], object],
        room: int = ...,
        rate: float | None = ...,
        refused: Callable[[str, MessageError], object] | None = ...,
    ) -> object:
        """Call `receive(path, payload)` for every sample on `path`."""

    def retract(self) -> None:
        """Take the subscriptions back."""


class Service(Protocol[C_co]):
    """What is configured, counted and received."""

    metrics: ServiceMetrics

    @property
    def config(self) -> C_co:
        """How ros2 is configured."""

    @property
    def bus(self) -> Samples:
        """Where the robot's samples come from."""

    def receive_latched(self, topic: Topic[M], accept: Callable[[M], None]) -> None:
        """Call `accept` for every good message that is kept or published."""


class Publisher(Protocol):
    """Takes the messages of one ROS topic."""

    @property
    def has_subscribers(self) -> bool:
        """Whether a message would be received."""

    def put(self, payload: bytes) -> None:
        """Publish a message's CDR."""


class Node(Protocol):
    """Where the ROS topics go."""

    def publisher(self, topic: str, interface: Interface, profile: Profile) -> Publisher:
        """Declare a publisher of `topic`, a name below the node's namespace."""
