"""Depth frames of a running simulation, `python -m simulator`; its wire is described in simulator/wire.py."""

import select
import time

import numpy as np

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics, check_camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame, SourceLost
from cliffscan.simulator import wire
from cliffscan.simulator.wire import FrameReader, WireError, WireFrame

CONNECTING = 2.0  # [s]
SILENCE = 3.0  # [s] without a frame until the simulation counts as lost
READ_SIZE = 1 << 20  # [bytes]


class Simulation:
    """Reads the frames of the simulation at an address, and stamps them as it does: with the clock's time.

    floor: where the camera is mounted, as far as anybody knows; the robot nods.
    Raises SourceLost where no simulation listens at the address, ConfigError where it is none.
    """

    def __init__(self, address: str, floor: FloorPlane) -> None:
        self._address, self._floor = address, floor
        self._reader = FrameReader()
        self._received_at = time.monotonic()
        try:
            self._connection = wire.connect(address, CONNECTING)
        except WireError as error:
            raise ConfigError(f"capture.simulation: {error}") from error
        except OSError as error:
            raise SourceLost(f"no simulation at {address} ({error}): start python -m simulator") from error

    def read(self, timeout: float) -> DepthFrame | None:
        """The newest frame not yet read, or None where none came within `timeout` [s].

        Raises SourceLost when the simulation has gone or is silent, BadFrame for a frame that no camera takes.
        """
        deadline = time.monotonic() + timeout
        while (left := deadline - time.monotonic()) > 0.0:
            if not select.select([self._connection], [], [], left)[0]:
                break
            if frames := self._receive():
                self._received_at = time.monotonic()
                return self._frame(frames[-1])
        if time.monotonic() - self._received_at > SILENCE:
            raise SourceLost(f"the simulation at {self._address} is silent")
        return None

    def close(self) -> None:
        """Hang up."""
        self._connection.close()

    def _receive(self) -> list[WireFrame]:
        try:
            data = self._connection.recv(READ_SIZE)
            if not data:
                raise SourceLost(f"the simulation at {self._address} has ended")
            return self._reader.feed(data)
        except (OSError, WireError) as error:
            raise SourceLost(f"the simulation at {self._address} is lost: {error}") from error

    def _frame(self, frame: WireFrame) -> DepthFrame:
        header, depth = frame
        rows, columns = depth.shape
        try:
            near, far = map(float, header["range"])
            intrinsics = Intrinsics(*map(float, header["intrinsics"]))
            sensor = float(header["noise"]), float(header["baseline"])
            camera = Camera(columns, rows, intrinsics, (near, far), self._floor, *sensor)
            check_camera(camera)
            return DepthFrame(depth.astype(np.uint16, copy=False), int(header["stamp"]), camera)
        except (KeyError, TypeError, ValueError) as error:
            raise BadFrame(f"a header of the simulation: {error!r}") from error
