"""A recording as its images, whatever its kind: a replay paces them, the demo and the commands do not."""

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

from cliffscan.services.capture.sources.depth_source import DepthFrame


class RecordedImage(NamedTuple):
    """One image of a recording. name: its own in the recording; read(): its frame. Raises BadFrame.

    The frame's stamp is 0 in a recording without stamps.
    """

    name: str
    read: Callable[[], DepthFrame]


class Origins(NamedTuple):
    """Where that comes from which a recording's pixels need to become points, in words."""

    units: str
    intrinsics: str
    range: str
    mount: str
    noise: str


class Recorded(Protocol):
    """A recording that is open. kind: what it is, in words; stamped: whether its frames have stamps of their own."""

    kind: str
    stamped: bool

    def __len__(self) -> int:
        """How many images it has."""

    def images(self) -> Iterator[RecordedImage]:
        """All images in order, each time from the first on; read each before the next."""

    def contents(self) -> list[str]:
        """What is in it, a line each."""

    def origins(self) -> Origins:
        """What its frames are made of; known when one has been read."""

    def close(self) -> None:
        """Close its files."""
