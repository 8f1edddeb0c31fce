"""Whether a process was asked to end."""

import os
import signal
from queue import Empty, SimpleQueue
from types import FrameType


class StopSignal:
    """Set by SIGTERM and Ctrl-C. While not patient, as in a long compilation, they end the process at once.

    A signal may come at any step of wait(), in the same thread. So no lock is taken: a threading.Event waits for ever
    for the one that its own thread holds. Of Python's queues SimpleQueue alone may be put to there.
    """

    def __init__(self) -> None:
        self.patient = True
        self._asked = False
        self._wakes: SimpleQueue[None] = SimpleQueue()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_signal)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self.set()
        if not self.patient:
            os._exit(0)  # an exception would get lost in the compiler's callbacks

    def is_set(self) -> bool:
        """Whether to end."""
        return self._asked

    def set(self) -> None:
        """Ask to end; from any thread, and from a signal's handler."""
        self._asked = True
        self._wakes.put(None)

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until asked to end, for `timeout` [s] at most; whether it was."""
        if not self._asked:
            try:
                self._wakes.get(timeout=None if timeout is None else max(timeout, 0.0))
            except Empty:
                return self._asked
            self._wakes.put(None)  # for the next one that waits
        return True
