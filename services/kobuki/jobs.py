"""What is to be done: put in by any thread, and done by one that waits for the base at the same time."""

from __future__ import annotations

import os
import select
from collections import deque
from collections.abc import Callable

from services.kobuki.port import Port

Job = Callable[[], None]
ROOM = 1024  # jobs that may wait; beyond, the oldest gives way


class Jobs:
    """A queue with a bell that can be waited for like a port, so that one wait, and one thread, serves both."""

    def __init__(self) -> None:
        self._jobs: deque[Job] = deque(maxlen=ROOM)
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def put(self, job: Job) -> bool:
        """Add a job. False where the oldest one had to make room."""
        had_room = len(self._jobs) < ROOM
        self._jobs.append(job)
        os.eventfd_write(self._bell, 1)
        return had_room

    def wait(self, port: Port | None, timeout: float) -> bool:
        """Wait for a job or the base, `timeout` [s] at most; whether the port can be read, or is gone."""
        sources: list[int | Port] = [self._bell, port] if port else [self._bell]
        ready, _, _ = select.select(sources, [], [], 0.0 if self._jobs else timeout)
        if self._bell in ready:
            os.eventfd_read(self._bell)
        return port in ready

    def take(self) -> Job | None:
        """The oldest job, if there is one."""
        return self._jobs.popleft() if self._jobs else None
