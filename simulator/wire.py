"""Frames on a stream socket, as `python -m simulator` sends them to whoever connects.

A frame is the length of its header (4 bytes, little-endian, unsigned), the header (JSON), and width · height depths
(16 bits, little-endian, unsigned), row by row from the top left: millimetres along the optical axis, 0 = no return.
The header is a map of

    seq         number of the frame
    stamp       [ns since the epoch] the clock's time when the world was so; the base's packets of that moment were
                written to its port just before
    time        [s] of the simulation, which goes slower than the clock where the machine is too slow
    rate        by how much: seconds of the simulation in one of the clock's, lately
    width, height, intrinsics [fx, fy, cx, cy] [px], range [min, max] [m]
    noise       [1/m] standard deviation of the inverse depth
    baseline    [m] between the sensor's two eyes
    truth       what no sensor tells: pose [x, y, yaw] [m, m, rad] of the middle between the wheels, viewpoint
                [x, y, yaw] below the camera, fallen, bumped (now), bumps (in all)

Where the camera truly is over the floor is not told: it is mounted as `python -m simulator` was told, and nods.
An address is a path, for a Unix socket, or HOST:PORT.
"""

import json
import socket
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cliffscan.simulator.unix_socket import connect_to, listen_at

LENGTH = struct.Struct("<I")
LONGEST_HEADER = 65536  # [bytes]
MOST_PIXELS = 2**22


class WireError(ValueError):
    """Bytes that are no frame, or an address that is none."""


class WireFrame(NamedTuple):
    """A header and its depth image: (rows, columns) [mm], 0 = no return."""

    header: dict[str, Any]
    depth: NDArray[np.uint16]


def pack(header: dict[str, Any], depth: NDArray[np.uint16]) -> bytes:
    """A frame as bytes. depth: (rows, columns) [mm]; its size is told in the header."""
    rows, columns = depth.shape
    told = json.dumps({**header, "width": columns, "height": rows}).encode()
    return LENGTH.pack(len(told)) + told + depth.astype("<u2").tobytes()


class FrameReader:
    """Finds frames in a stream of bytes, however it is cut."""

    def __init__(self) -> None:
        self._pending = bytearray()

    def feed(self, data: bytes) -> list[WireFrame]:
        """The frames that are complete with these bytes. Raises WireError for what can be no frame."""
        self._pending += data
        frames = []
        while frame := self._take():
            frames.append(frame)
        return frames

    def _take(self) -> WireFrame | None:
        if len(self._pending) < LENGTH.size:
            return None
        (size,) = LENGTH.unpack_from(self._pending)
        if size > LONGEST_HEADER:
            raise WireError(f"a header of {size} bytes, expected at most {LONGEST_HEADER}")
        body = LENGTH.size + size
        if len(self._pending) < body:
            return None
        header, rows, columns = read_header(bytes(self._pending[LENGTH.size : body]))
        end = body + 2 * rows * columns
        if len(self._pending) < end:
            return None
        depth = np.frombuffer(bytes(self._pending[body:end]), "<u2").reshape(rows, columns)
        del self._pending[:end]
        return WireFrame(header, depth)


def read_header(data: bytes) -> tuple[dict[str, Any], int, int]:
    """A header, its rows and its columns. Raises WireError for one that is none."""
    try:
        header = json.loads(data)
        rows, columns = int(header["height"]), int(header["width"])
    except (ValueError, KeyError, TypeError) as error:
        raise WireError(f"no header of a frame: {data[:60]!r}") from error
    if min(rows, columns) < 1 or rows * columns > MOST_PIXELS:
        raise WireError(f"an image of {columns}x{rows}, expected at most {MOST_PIXELS} pixels")
    return header, rows, columns


def connect(address: str, patience: float) -> socket.socket:
    """A connection to an address. Raises OSError where nobody listens there, WireError for what is no address."""
    if "/" not in address:
        return socket.create_connection(host_and_port(address), patience)
    return connect_to(Path(address), patience)


def listen(address: str) -> socket.socket:
    """A socket that listens at an address; a path that nobody listens at any more is taken over.

    Raises OSError where it cannot listen, WireError for what is no address.
    """
    if "/" not in address:
        return socket.create_server(host_and_port(address))
    return listen_at(Path(address))


def host_and_port(address: str) -> tuple[str, int]:
    """The parts of HOST:PORT. Raises WireError for anything else."""
    host, _, port = address.rpartition(":")
    if not host or not port.isdecimal() or int(port) > 65535:
        raise WireError(f"{address!r} is no address: expected a path with a slash, or HOST:PORT")
    return host, int(port)
