"""What every source of depth frames has in common."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.description import Place


class DepthFrame(NamedTuple):
    """One depth image. depth: (rows, columns) [mm], 0 = no return; stamp: time of capture [ns since the epoch].

    period [s]: from one frame to the next; None where it is that of the configured rate.
    place: where the camera stands on the base; None where it is as configured.
    """

    depth: NDArray[np.uint16]
    stamp: int
    camera: Camera
    period: float | None = None
    place: Place | None = None


class SourceLost(Exception):
    """The device is not there, or has gone; the message says which and the remedy. Open it again later."""


class SourceEnded(Exception):
    """The last frame has been read; there will be no other."""


class BadFrame(Exception):
    """One frame could not be had; the next one may be good."""


class Source(Protocol):
    """A stream of depth frames, read one at a time; opened by its constructor."""

    def read(self, timeout: float) -> DepthFrame | None:
        """The next frame, or None where none came within `timeout` [s].

        Raises SourceLost, SourceEnded or BadFrame.
        """

    def close(self) -> None:
        """Release the device. Nothing is read after it."""
