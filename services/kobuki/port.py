"""The serial port of the base: opened, read by a thread, written to, and guarded to the last."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import serial

from services.kobuki import guard
from services.kobuki.commands import base_control

BAUD = 115_200
WAIT = 0.1  # [s] after which the reader looks whether the port was closed
WRITE_TIMEOUT = 0.1  # [s]
GUARD_PATIENCE = 1.0  # [s] for its last stops
CHUNK = 4096
REMEDIES = {
    errno.ENOENT: "no such device: plug the base in, switch it on, and install udev/60-kobuki.rules",
    errno.EACCES: "permission denied: join the group dialout and log in again, or install udev/60-kobuki.rules",
    errno.EBUSY: "another program has it: end that first",
    errno.EAGAIN: "another program has it: end that first",
}


class PortLost(Exception):
    """The port cannot be had, or has gone; one line with the remedy."""


class Port:
    """The open port.

    `received` is called from a thread of its own with each piece of the stream, and with b"" when the port is gone.
    Raises PortLost where it cannot be opened.
    """

    def __init__(self, path: str, received: Callable[[bytes], None]) -> None:
        self._path = path
        try:
            self._serial = serial.Serial(path, BAUD, timeout=WAIT, write_timeout=WRITE_TIMEOUT, exclusive=True)
        except (OSError, ValueError) as error:
            raise PortLost(f"{path}: {_remedy(error)}") from error
        self._received = received
        self._closed = threading.Event()
        heart, self._heart = os.pipe()
        os.set_blocking(self._heart, False)
        port = self._serial.fileno()
        self._guard = subprocess.Popen(
            [sys.executable, "-SE", str(Path(guard.__file__)), str(port), str(heart), base_control(0.0, 0.0).hex()],
            pass_fds=(port, heart),
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
        os.close(heart)
        self._reader = threading.Thread(target=self._read, name="port", daemon=True)
        self._reader.start()

    def write(self, data: bytes) -> None:
        """Send bytes to the base. Raises PortLost."""
        try:
            self._serial.write(data)
        except (OSError, serial.SerialException) as error:
            raise PortLost(f"{self._path}: {_remedy(error)}") from error

    def beat(self) -> None:
        """Tell the guard that all is well; to be called more often than it is patient."""
        try:
            os.write(self._heart, b".")
        except BlockingIOError:
            pass  # it has enough to read
        except BrokenPipeError as error:
            raise PortLost(f"{self._path}: the guard of the port has died") from error

    def close(self) -> None:
        """Have the guard say the last word, and let go of the port."""
        self._closed.set()
        os.close(self._heart)
        try:
            self._guard.wait(GUARD_PATIENCE)
        except subprocess.TimeoutExpired:
            self._guard.kill()
            self._guard.wait()
        self._reader.join()
        self._serial.close()

    def _read(self) -> None:
        while not self._closed.is_set():
            try:
                data = self._serial.read(1)
                data += self._serial.read(min(self._serial.in_waiting, CHUNK))
            except (OSError, TypeError, serial.SerialException):  # pyserial's ways to tell of an unplugged device
                self._received(b"")
                return
            if data:
                self._received(data)


def _remedy(error: Exception) -> str:
    number = getattr(error, "errno", None)
    return REMEDIES.get(number or 0, f"{error}: is the base plugged in and switched on?")
