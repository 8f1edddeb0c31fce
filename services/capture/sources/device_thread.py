"""A device whose calls may take for ever: one thread makes them all, and nobody waits for it without a limit."""

import logging
import threading
import time
from collections.abc import Callable
from contextlib import closing
from typing import Generic, Protocol, TypeVar

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources.depth_source import SourceLost

PATIENCE = 0.5  # [s] longest wait for the device's thread, when opening and when closing
SILENCE = 3.0  # [s] without a frame until the device counts as lost
TURN = 0.1  # [s] longest wait for the device in one call of serve(), so how soon the thread sees that it shall end

Frame = TypeVar("Frame")

log = logging.getLogger(__name__)


class Stream(Protocol):
    """A device's calls in order, all in one thread; its maker opens it, or raises SourceLost or ConfigError."""

    def serve(self) -> None:
        """Wait for what the device sends, for TURN at most, and pass each frame on. Raises SourceLost."""

    def close(self) -> None:
        """Stop the stream and release the device."""


class DeviceThread(Generic[Frame]):
    """The stream of one device, a queue of one: a frame that nobody has read gives way to the next.

    name: the device in messages; one process opens no name twice. remedy: what to do when it is silent.
    open_stream: opens the device; the stream calls what it is given with each frame.
    Raises SourceLost or ConfigError as `open_stream` does. A device that takes longer than PATIENCE is still opening
    when the constructor returns; read() then reports how it went.
    """

    def __init__(self, name: str, remedy: str, open_stream: Callable[[Callable[[Frame], None]], Stream]) -> None:
        self._name, self._remedy, self._open_stream = name, remedy, open_stream
        self._changed = threading.Condition()  # guards the next four
        self._newest: Frame | None = None
        self._opened = False
        self._failure: SourceLost | ConfigError | None = None
        self._received_at = time.monotonic()
        self._closing = threading.Event()
        if any(thread.name == name for thread in threading.enumerate()):
            raise SourceLost(f"this process has not let go of {name} yet: unplug it, or restart the service")
        self._driver = threading.Thread(target=self._drive, name=name, daemon=True)
        self._driver.start()
        with self._changed:
            self._changed.wait_for(lambda: self._opened or self._failure, PATIENCE)
        if self._failure:
            self.close()
            raise self._failure

    def read(self, timeout: float) -> Frame | None:
        """The newest frame not yet read, or None if none came within `timeout` [s].

        Raises SourceLost when the device is gone or has sent nothing for SILENCE, and what opening it raised.
        """
        with self._changed:
            patience = min(timeout, self._received_at + SILENCE - time.monotonic())
            self._changed.wait_for(lambda: self._newest is not None or self._failure, patience)
            newest, self._newest = self._newest, None
            silence = time.monotonic() - self._received_at
        if newest is not None:
            return newest
        if self._failure:
            raise self._failure
        if silence >= SILENCE:
            raise SourceLost(f"{self._name} is silent for {silence:.1f} s: {self._remedy}")
        return None

    def close(self) -> None:
        """Release the device. A driver that does not let go of it within PATIENCE is left to itself."""
        self._closing.set()
        self._driver.join(PATIENCE)
        if self._driver.is_alive():
            log.warning("%s does not close; its thread is left to wait for it", self._name)

    def _drive(self) -> None:
        """The device's thread: open the stream, serve it until close(), release it."""
        try:
            with closing(self._open_stream(self._arrived)) as stream:
                with self._changed:
                    self._opened, self._received_at = True, time.monotonic()
                    self._changed.notify_all()
                while not self._closing.is_set():
                    stream.serve()
        except (SourceLost, ConfigError) as failure:
            with self._changed:
                self._failure = failure
                self._changed.notify_all()

    def _arrived(self, frame: Frame) -> None:
        with self._changed:
            self._newest, self._received_at = frame, time.monotonic()
            self._changed.notify_all()
