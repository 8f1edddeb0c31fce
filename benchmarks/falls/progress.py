"""One line on the terminal that says how far the work is."""

from __future__ import annotations

import sys
from time import perf_counter

from benchmarks.falls.outcome import Outcome

STEPS = 20  # lines in all where the output is no terminal


class ProgressLine:
    """Told of every run that is done, it writes to stderr. runs: how many there will be."""

    def __init__(self, runs: int) -> None:
        self._runs, self._start = runs, perf_counter()
        self._done, self._minutes, self._falls = 0, 0.0, 0

    def done(self, outcome: Outcome) -> None:
        """Another one."""
        self._done += 1
        self._minutes += outcome.seconds / 60.0
        self._falls += outcome.count("fall")
        steps = [count * STEPS // self._runs for count in (self._done - 1, self._done)]
        if sys.stderr.isatty():
            print(f"\r{self._text():<90}", end="\n" if self._done == self._runs else "", file=sys.stderr, flush=True)
        elif steps[0] < steps[1]:
            print(self._text(), file=sys.stderr, flush=True)

    def _text(self) -> str:
        passed = perf_counter() - self._start
        left = passed / self._done * (self._runs - self._done)
        return (
            f"{self._done} of {self._runs} runs, {self._minutes:.0f} min simulated, {self._falls} falls, "
            f"{passed:.0f} s, {left:.0f} s left"
        )
