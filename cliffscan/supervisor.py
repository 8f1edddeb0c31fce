"""Processes that are started together, restarted when they end, and ended together."""

import logging
import subprocess
import time
from collections.abc import Sequence
from typing import Self

FIRST_DELAY, LONGEST_DELAY = 0.5, 10.0  # [s] before a restart; doubled each time
STEADY = 10.0  # [s] a process must have run for its delay to begin anew
GRACE = 10.0  # [s] to end by itself, on a slow machine that is busy too
CONFIG_REFUSED = 2

log = logging.getLogger("cliffscan")


class ConfigRefused(Exception):
    """A process did not accept its configuration; it has said why."""


class Child:
    """One process and its restarts.

    finite: whether exit 0 means that its work is done. All others work until they are ended: any exit is a fault.
    """

    def __init__(self, name: str, command: Sequence[str], finite: bool = False) -> None:
        self.name = name
        self._command = command
        self._finite = finite
        self._done = False
        self._delay = FIRST_DELAY
        self._restart_at = 0.0
        self._start()

    @property
    def pid(self) -> int:
        """Its process number, the last one where it has ended."""
        return self._process.pid

    def poll(self, now: float) -> None:
        """Start it again when it has ended and its delay is over. Raises ConfigRefused."""
        code = self._process.poll()
        if code is None or self._done:
            return
        if code == CONFIG_REFUSED:
            raise ConfigRefused(self.name)
        if code == 0 and self._finite:
            self._done = True
            log.info("%s has done its work", self.name)
        elif not self._restart_at:
            if now - self._born > STEADY:
                self._delay = FIRST_DELAY
            log.warning("%s ended (%s); starting it again in %g s", self.name, _reason(code), self._delay)
            self._restart_at = now + self._delay
            self._delay = min(2 * self._delay, LONGEST_DELAY)
        elif now >= self._restart_at:
            self._start()

    def ask_to_end(self) -> None:
        """Send SIGTERM to it if it runs."""
        if self._process.poll() is None:
            self._process.terminate()

    def end(self, deadline: float) -> None:
        """Wait for its end until `deadline`, then kill it."""
        try:
            self._process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            log.warning("%s does not end; killing it", self.name)
            self._process.kill()
            self._process.wait()

    def _start(self) -> None:
        # In a session of its own: a terminal's Ctrl-C reaches the supervisor alone, which ends all in their order.
        self._process = subprocess.Popen(self._command, stdin=subprocess.DEVNULL, start_new_session=True)
        self._born = time.monotonic()
        self._restart_at = 0.0


class Supervisor:
    """Keeps processes running. A context manager: leaving it ends them all.

    Those that were started last are asked to end first. What others stand on ends after them, so that they do not
    complain of its end.
    """

    def __init__(self) -> None:
        self.children: dict[str, Child] = {}
        self._ground: set[str] = set()

    def start(self, name: str, command: Sequence[str], finite: bool = False, ground: bool = False) -> None:
        """Start a process and keep it running, in the place of one of that name.

        finite: exit 0 means that its work is done; ground: others stand on it.
        """
        if name in self.children:
            _end([self.children[name]])
        if ground:
            self._ground.add(name)
        self.children[name] = Child(name, command, finite)

    def poll(self) -> None:
        """Look after all processes; to be called a few times a second. Raises ConfigRefused."""
        for child in self.children.values():
            child.poll(time.monotonic())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        children = list(reversed(self.children.values()))
        _end([child for child in children if child.name not in self._ground])
        _end([child for child in children if child.name in self._ground])


def _end(children: Sequence[Child]) -> None:
    """Ask all to end, then wait for each until the same deadline."""
    deadline = time.monotonic() + GRACE
    for child in children:
        child.ask_to_end()
    for child in children:
        child.end(deadline)


def _reason(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit {code}"
