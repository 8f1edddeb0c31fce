"""One line on the terminal that says how far the work is."""

from __future__ import annotations

import sys
from time import perf_counter

from benchmarks.accuracy.measure import Progress

PAUSE = 0.2  # [s] between two updates
STEPS = 10  # lines in all where the output is no terminal


def progress_line() -> Progress:
    """What measure tells its progress to; it writes to stderr."""
    start = shown = perf_counter()

    def show(done: int, whole: int) -> None:
        nonlocal shown
        now = perf_counter()
        terminal = sys.stderr.isatty()
        due = now - shown > PAUSE if terminal else done * STEPS // whole > (done - 1) * STEPS // whole
        if due or done == whole:
            shown = now
            left = (now - start) / done * (whole - done)
            text = f"{done} of {whole} frames and sequences, {now - start:.0f} s, {left:.0f} s left"
            print(f"\r{text:<70}" if terminal else text, end="" if terminal and done < whole else "\n", file=sys.stderr)

    return show
