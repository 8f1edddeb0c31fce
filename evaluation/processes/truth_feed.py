"""Where a simulated robot truly is, frame by frame: what no sensor tells, received from its simulation."""

import contextlib
import socket
import threading
from typing import Any, NamedTuple

from cliffscan.simulator import wire
from cliffscan.simulator.wire import FrameReader
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


class TruthFeed:
    """Listens to the simulation at an address, beside capture. Raises OSError where nobody answers."""

    def __init__(self, address: str) -> None:
        self.by_stamp: dict[int, Truth] = {}  # [ns], as the frames and their scans are stamped
        self._connection = wire.connect(address, PATIENCE)
        self._connection.settimeout(None)
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Hang up."""
        with contextlib.suppress(OSError):  # the simulation has hung up already
            self._connection.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._connection.close()

    def _listen(self) -> None:
        reader = FrameReader()
        with contextlib.suppress(OSError):
            while data := self._connection.recv(READ_SIZE):
                for header, _ in reader.feed(data):
                    self.by_stamp[int(header["stamp"])] = truth_in(header)


def truth_in(header: dict[str, Any]) -> Truth:
    """The truth in a frame's header."""
    told = header["truth"]
    return Truth(header["time"], Pose(*told["pose"]), Pose(*told["viewpoint"]), told["fallen"], told["bumps"])
