"""The services' log lines: kept in a file, and only complaints shown, so that they do not tear up the progress bar."""

import os
import re
import sys
from pathlib import Path
from typing import Self

STDERR = 2
PREFIX = re.compile(r"^\d{4}-\d\d-\d\d \S+ (?P<level>[A-Z]+) (?P<text>.*)$")
COUNT = re.compile(r" \(\d+ so far\)")
NUMBER = re.compile(r"\d+")
QUIET = ("DEBUG", "INFO")


class ServiceLog:
    """A context manager: within it, all that this process and its children write to stderr is added to a file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._told: set[str] = set()

    def __enter__(self) -> Self:
        sys.stderr.flush()
        self._stderr = os.dup(STDERR)
        with self.path.open("a") as written:
            os.dup2(written.fileno(), STDERR)
        self._written = self.path.open(encoding="utf-8", errors="replace")
        self._written.seek(0, os.SEEK_END)
        self._line = ""
        return self

    def __exit__(self, *_: object) -> None:
        sys.stderr.flush()
        os.dup2(self._stderr, STDERR)
        os.close(self._stderr)
        self._written.close()

    def complaints(self) -> list[str]:
        """The lines since this was last asked that a person should see; of those that differ in numbers, the first."""
        *lines, self._line = (self._line + self._written.read()).split("\n")
        return [line for line in map(complaint, lines) if self._is_new(line)]

    def silence(self, line: str) -> None:
        """Take this complaint for told."""
        self._told.add(NUMBER.sub("", line))

    def _is_new(self, line: str) -> bool:
        key = NUMBER.sub("", line)
        if not line or key in self._told:
            return False
        self._told.add(key)
        return True


def complaint(line: str) -> str:
    """What a log line complains of, without its time and its count; empty where it is none."""
    found = PREFIX.match(line)
    if not found:
        return line.rstrip()  # not of a logger: a refused configuration, a traceback
    return "" if found["level"] in QUIET else COUNT.sub("", found["text"])
