"""Where a simulated robot truly is, frame by frame: what no sensor tells, received from its simulation."""

import contextlib
import socket
import threading
from collections.abc import Callable
from typing import NamedTuple

from cliffscan.simulator import wire
from cliffscan.simulator.wire import FrameReader, WireFrame
from cliffscan.simulator.world import Pose

PATIENCE = 5.0  # [s]
READ_SIZE = 1 << 20  # [bytes]


class Truth(NamedTuple):
    """The robot at the moment of a frame."""

    time: float  # [s] of the simulation
    pose: Pose  # of base_link
    viewpoint: Pose  # of the floor below the camera
    fallen: bool
    bumps: int  # so far


class FrameFeed:
    """Hands on every frame that a simulation sends at an address. Raises OSError where nobody answers."""

    def __init__(self, address: str, take: Callable[[WireFrame], None]) -> None:
        self._connection = wire.connect(address, PATIENCE)
        self._connection.settimeout(None)
        self._thread = threading.Thread(target=self._listen, args=(take,), daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Hang up."""
        with contextlib.suppress(OSError):  # the simulation has hung up already
            self._connection.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._connection.close()

    def _listen(self, take: Callable[[WireFrame], None]) -> None:
        reader = FrameReader()
        with contextlib.suppress(OSError):
            while data := self._connection.recv(READ_SIZE):
                for frame in reader.feed(data):
                    take(frame)


class TruthFeed(FrameFeed):
    """The truth of each frame, received beside capture. Raises OSError where nobody answers."""

    def __init__(self, address: str) -> None:
        self.by_stamp: dict[int, Truth] = {}  # [ns], as the frames and their scans are stamped
        super().__init__(address, self._keep)

    def _keep(self, frame: WireFrame) -> None:
        header, told = frame.header, frame.header["truth"]
        self.by_stamp[int(header["stamp"])] = Truth(
            header["time"], Pose(*told["pose"]), Pose(*told["viewpoint"]), told["fallen"], told["bumps"]
        )
