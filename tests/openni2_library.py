"""OpenNI2 itself with its Dummy device, whose thread still uses a stream for 33 ms after it was stopped.

A process of capture that waits for the end of that thread: `python -m tests.openni2_library OPTION ...`, the options
are capture's. Without the wait the device may crash its process; drivers of real cameras end their threads themselves.
"""

import runpy
import time
from pathlib import Path

import pytest

from cliffscan.services.capture.sources import libopenni2

DEADLINE = 60.0  # [s]
THREADS = Path("/proc/self/task")


def _installed() -> bool:
    try:
        libopenni2.load()
    except OSError:
        return False
    return True


needs_openni2 = pytest.mark.skipif(not _installed(), reason="needs Debian's package libopenni2-0 (OpenNI2)")


def threads():
    return {each.name for each in THREADS.iterdir()}


class Library:
    """The `real` library, of which single functions are `others`. calls: the functions that were called, in order."""

    def __init__(self, real, **others) -> None:
        self._real, self._others, self.calls = real, others, []
        self._others |= {"oniStreamStart": self._start, "oniStreamStop": self._stop}
        self._of_stream = set()

    def __getattr__(self, name):
        function = self._others.get(name) or getattr(self._real, name)

        def call(*arguments):
            self.calls.append(name)
            return function(*arguments)

        return call

    def _start(self, stream):
        before = threads()
        status = self._real.oniStreamStart(stream)
        self._of_stream = threads() - before
        return status

    def _stop(self, stream):
        self._real.oniStreamStop(stream)
        deadline = time.monotonic() + DEADLINE
        while self._of_stream & threads():
            assert time.monotonic() < deadline
            time.sleep(0.001)


if __name__ == "__main__":
    library = Library(libopenni2.load())
    libopenni2.load = lambda: library
    runpy.run_module("services.capture", run_name="__main__")
