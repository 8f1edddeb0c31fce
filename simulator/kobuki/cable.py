"""The cable: a pty, and a link that tells a driver where it is."""

import contextlib
import os
import termios
import tty
from collections.abc import Iterable
from pathlib import Path

READ_SIZE = 4096  # [bytes]


class PathError(Exception):
    """A path at which no port, or no socket, can be made."""


class Cable:
    """A serial port at the path of a link; the link comes and goes with the plug, as udev's does.

    What is said while no driver has the port open is lost, as on a real one: nobody ever reads old bytes.

    Raises PathError where the link cannot be made, or would replace something that is no link.
    """

    def __init__(self, link: Path) -> None:
        self.link = link
        self.device = ""
        self.connected = False  # whether a driver has the port open
        self._master = -1
        self.plug()

    @property
    def plugged(self) -> bool:
        """False while the cable is out."""
        return self._master >= 0

    def fileno(self) -> int:
        """What to wait on for a driver's bytes, while a driver is connected."""
        return self._master

    def plug(self) -> None:
        """Put the cable in: open a new port and link it."""
        self._master, slave = os.openpty()
        tty.setraw(slave)
        self.device = os.ttyname(slave)
        os.close(slave)  # so that a driver's coming and going shows
        os.set_blocking(self._master, False)
        try:
            self._make_link()
        except PathError:
            self.unplug()
            raise

    def unplug(self) -> None:
        """Pull the cable out: a driver that has the port open finds it hung up."""
        self._remove_link()
        os.close(self._master)
        self._master = -1
        self.connected = False

    def close(self) -> None:
        """Leave nothing behind."""
        if self.plugged:
            self.unplug()

    def hear(self, room: int | None = None) -> bytes:
        """What a driver wrote since the last time; where there is `room` [bytes] for so much only, the rest waits."""
        heard = b""
        try:
            while data := os.read(self._master, READ_SIZE if room is None else min(room - len(heard), READ_SIZE)):
                heard += data
                self.connected = True
        except BlockingIOError:
            self.connected = True
        except OSError:  # EIO: nobody has the port open
            if self.connected:
                self._forget()
            self.connected = False
        return heard

    def say(self, pieces: Iterable[bytes]) -> None:
        """Write each piece by itself; what does not fit because a driver does not read is lost."""
        if not self.connected:
            return
        try:
            for piece in pieces:
                os.write(self._master, piece)
        except BlockingIOError:
            return

    def _forget(self) -> None:
        """Drop what a driver that left had set and not read, as a serial port does when it is closed."""
        with contextlib.suppress(OSError):  # EBUSY, where it left the port locked: its successor will not get in either
            slave = os.open(self.device, os.O_RDWR | os.O_NOCTTY)
            tty.setraw(slave, termios.TCSANOW)
            termios.tcflush(slave, termios.TCIFLUSH)
            os.close(slave)

    def _make_link(self) -> None:
        fresh = self.link.with_name(f".{self.link.name}.{os.getpid()}")
        try:
            if self.link.exists() and not self.link.is_symlink():
                raise PathError(f"{self.link} is there and is no link; choose another path")
            fresh.symlink_to(self.device)
            fresh.replace(self.link)
        except OSError as error:
            raise PathError(f"cannot link {self.link}: {error.strerror}") from error

    def _remove_link(self) -> None:
        if self.link.is_symlink() and str(self.link.readlink()) == self.device:
            self.link.unlink()
