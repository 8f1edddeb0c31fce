"""A thread for each subscription and each answered path, fed through a ring of Zenoh's own.

Zenoh calls a Python function through a bounded channel, and its session waits where that is full, so that a flood on
one key would delay every other. A ring drops its oldest entry instead, in native code; a dropped request ends for its
asker.
"""

import logging
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import zenoh

from cliffscan.common.runtime.pace import Pace

ENDING = 0.5  # [s]

log = logging.getLogger(__name__)


class Readers:
    """The threads of one session.

    They must have ended before the interpreter does: one that still waits in native code then aborts the process.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._threads: list[threading.Thread] = []

    def read(self, source: Any, handle: Callable[[Any], object], pace: Pace | None = None) -> None:  # noqa: ANN401
        """Call `handle` for all that comes from `source`, a declaration with a ring, until it or its session ends."""
        self._start(str(source.key_expr), lambda: _run(source, handle, pace))

    def once(self, name: str, work: Callable[[], object]) -> None:
        """Do a piece of work that waits for others, beside all that is read."""
        self._start(name, lambda: guarded(name, work))

    def join(self) -> None:
        """Wait until all threads have ended, once the session is closed, for no longer than ENDING."""
        deadline = time.monotonic() + ENDING
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join(max(deadline - time.monotonic(), 0.0))

    def _start(self, name: str, run: Callable[[], None]) -> None:
        thread = threading.Thread(target=run, name=f"bus {name}", daemon=True)
        thread.start()
        with self._lock:
            self._threads = [each for each in (*self._threads, thread) if each.is_alive()]


def guarded(name: str, work: Callable[[], object]) -> None:
    """Do a piece of work; what goes wrong costs that piece alone."""
    try:
        work()
    except zenoh.ZError as error:  # the session was closed in the meantime
        log.debug("%s: %s", name, error)
    except Exception:
        log.exception("%s: an error of the program", name)


def _run(source: Any, handle: Callable[[Any], object], pace: Pace | None) -> None:  # noqa: ANN401
    name, ring = str(source.key_expr), source.handler  # who waits in `source` itself keeps it from being taken back
    while True:
        if pace and (delay := pace.delay(time.monotonic())):
            time.sleep(delay)
        try:
            item = ring.recv()
        except zenoh.ZError:  # the declaration or the session has ended
            return
        if pace:
            pace.spend(time.monotonic())
        guarded(name, partial(handle, item))
