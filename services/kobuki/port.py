"""The serial port of the base: opened, read, written to, and guarded to the last."""

import errno
import fcntl
import os
import select
import subprocess
import sys
import termios
from contextlib import suppress
from pathlib import Path

import serial

from cliffscan.common.runtime.command_handlers import CannotDo
from cliffscan.services.kobuki import guard
from cliffscan.services.kobuki.protocol.commands import base_control

BAUD = 115_200
GUARD_PATIENCE = 1.0  # [s] for its last stops
CHUNK = 4096
BACKLOG = 56  # [bytes] of four commands, beyond which a slow line would make the next ones late
PSEUDO_TERMINALS = range(136, 144)  # major device numbers on Linux
REMEDIES = {
    errno.ENOENT: "no such device: plug the base in, switch it on, and install udev/60-kobuki.rules",
    errno.EACCES: "permission denied: join the group dialout and log in again, or install udev/60-kobuki.rules",
    errno.EPERM: "not permitted: restart the unit or container that this runs in, now that the base is plugged in",
    errno.EBUSY: "another program has it: end that first",
    errno.EAGAIN: "another program has it: end that first",
}


class PortLost(CannotDo):
    """The port cannot be had, or has gone; one line with the remedy."""


class Port:
    """The open port. Raises PortLost where it cannot be opened."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._rest = b""  # of a frame that the port took a part of
        try:
            self._serial = serial.Serial(path, BAUD, timeout=0.0, exclusive=True)
        except (OSError, ValueError) as error:
            raise PortLost(f"{path}: {_remedy(error)}") from error
        heart, self._heart = os.pipe()
        os.set_blocking(self._heart, False)
        port = self._file = self._serial.fileno()
        self._guard = subprocess.Popen(
            [sys.executable, "-SE", str(Path(guard.__file__)), str(port), str(heart), base_control(0.0, 0.0).hex()],
            pass_fds=(port, heart),
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
        os.close(heart)

    def fileno(self) -> int:
        """What can be waited for: it is readable when the base sent something, and when it is gone."""
        return self._file

    def read(self) -> bytes:
        """What the base sent, once the port is readable. Raises PortLost where that is nothing."""
        try:
            data = os.read(self._file, CHUNK)
        except OSError as error:
            raise PortLost(f"{self._path}: the base was unplugged") from error
        if not data:
            raise PortLost(f"{self._path}: the base was unplugged")
        return data

    def has_more(self) -> bool:
        """Whether the base sent something that was not read yet."""
        return bool(select.select([self], [], [], 0.0)[0])

    def write(self, data: bytes) -> bool:
        """Send bytes to the base, whole or not at all; false where the line is busy and nothing was sent.

        Nothing here waits: what a slow line does not take now is old when it does. Raises PortLost.
        """
        if self._waiting() > BACKLOG:
            self._discard()
        if self._rest and not self._send_rest():
            return False
        sent = self._take(data)
        if sent < len(data):
            self._rest = data[sent:] if sent else b""
        return bool(sent)

    def stop(self, data: bytes) -> None:
        """Send the bytes that stop the base, before all that still waits in the port. Raises PortLost.

        What waits is discarded, perhaps in the middle of a frame, whose rest the base then takes from the first stop;
        so there are two.
        """
        self._discard()
        self.write(data)
        self.write(data)

    @property
    def emulated(self) -> bool:
        """Whether it is a pseudo-terminal, behind which no real base stands."""
        return os.major(os.fstat(self.fileno()).st_rdev) in PSEUDO_TERMINALS

    def beat(self) -> None:
        """Show the guard that all is well; to be called more often than it is patient."""
        try:
            os.write(self._heart, b".")
        except BlockingIOError:
            pass  # it has enough to read
        except BrokenPipeError as error:
            raise PortLost(f"{self._path}: the guard of the port has died") from error

    def close(self) -> None:
        """Stop the base, have the guard, if it lives, send the last stops, and let go of the port."""
        with suppress(PortLost):
            self.stop(base_control(0.0, 0.0))
        os.close(self._heart)
        try:
            self._guard.wait(GUARD_PATIENCE)
        except subprocess.TimeoutExpired:
            self._guard.kill()
            self._guard.wait()
        self._serial.close()

    def _waiting(self) -> int:
        """How many bytes the line has not carried yet, where the device reports it."""
        try:
            return int.from_bytes(fcntl.ioctl(self._file, termios.TIOCOUTQ, bytes(4)), sys.byteorder)
        except OSError as error:
            raise PortLost(f"{self._path}: {_remedy(error)}") from error

    def _discard(self) -> None:
        """Throw away what waits."""
        self._rest = b""
        try:
            termios.tcflush(self.fileno(), termios.TCOFLUSH)
        except termios.error as error:
            raise PortLost(f"{self._path}: the base was unplugged") from error

    def _send_rest(self) -> bool:
        """Send the end of a frame that the port took a part of; whether it is sent."""
        self._rest = self._rest[self._take(self._rest) :]
        return not self._rest

    def _take(self, data: bytes) -> int:
        """How many bytes the port takes now."""
        try:
            return os.write(self._file, data)
        except BlockingIOError:
            return 0
        except OSError as error:
            raise PortLost(f"{self._path}: {_remedy(error)}") from error


def _remedy(error: Exception) -> str:
    number = getattr(error, "errno", None)
    return REMEDIES.get(number or 0, f"{error}: is the base plugged in and switched on?")
