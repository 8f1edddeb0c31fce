"""What is to be done: put in by any thread, and done by one that may wait for a port at the same time."""

import os
import select
from collections import deque
from collections.abc import Callable
from typing import Protocol

Job = Callable[[], None]
ROOM = 64  # jobs that may wait, of each kind


class Port(Protocol):
    """What can be waited for beside the jobs."""

    def fileno(self) -> int:
        """The descriptor that becomes readable."""


class WakeableQueue:
    """Three queues with one bell that can be waited for like a port, so that one wait, and one thread, serves all.

    Urgent jobs, such as a stop, come first and are never lost. A job with a key gives way to the next one with that
    key: of a driver's commands only the newest counts. Of all others the oldest gives way where there is no room.
    """

    def __init__(self) -> None:
        self._urgent: deque[Job] = deque()
        self._newest: dict[str, Job] = {}
        self._others: deque[Job] = deque(maxlen=ROOM)
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def put_urgent(self, job: Job) -> None:
        """Add a job that is done before all others; its caller waits for it, so there are never many."""
        self._urgent.append(job)
        self._ring()

    def put_newest(self, key: str, job: Job) -> bool:
        """Add a job in the place of the last one with this key. False where there is no room for another key."""
        if len(self._newest) >= ROOM and key not in self._newest:
            return False
        self._newest[key] = job
        self._ring()
        return True

    def put(self, job: Job) -> bool:
        """Add a job. False where the oldest one had to make room."""
        had_room = len(self._others) < ROOM
        self._others.append(job)
        self._ring()
        return had_room

    def wait(self, port: Port | None, timeout: float) -> bool:
        """Wait for a job or the port, `timeout` [s] at most; whether the port can be read, or is gone."""
        waiting = self._urgent or self._newest or self._others
        sources: list[int | Port] = [self._bell, port] if port else [self._bell]
        ready, _, _ = select.select(sources, [], [], 0.0 if waiting else timeout)
        if self._bell in ready:
            os.eventfd_read(self._bell)
        return port in ready

    def take(self) -> list[Job]:
        """All urgent jobs, the newest ones, and the oldest of the others."""
        jobs = [self._urgent.popleft() for _ in range(len(self._urgent))]
        jobs += [self._newest.pop(key) for key in list(self._newest)]
        if self._others:
            jobs.append(self._others.popleft())
        return jobs

    def _ring(self) -> None:
        os.eventfd_write(self._bell, 1)
