"""Much work, the same results however many processes share it, and a line on the terminal that says how far it is."""

import multiprocessing
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from time import perf_counter
from typing import TypeVar

Work = TypeVar("Work")
Result = TypeVar("Result")

PAUSE = 0.2  # [s] between two updates of the line
LINES = 20  # in all where the output is no terminal


def in_order(
    job: Callable[[Work], Result],
    work: Sequence[Work],
    jobs: int,
    warm_up: Callable[[], object],
    renew: int | None = None,
) -> Iterator[Result]:
    """What a job makes of each piece of work, in that order.

    warm_up compiles the kernels once, before the processes part. renew: pieces of work after which a process is
    replaced by a new one.
    """
    if jobs == 1 or len(work) < 2:
        yield from map(job, work)
        return
    warm_up()
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=renew) as pool:
        yield from pool.imap(job, work)


def counted(results: Iterable[Result], whole: int, about: Callable[[], str] = lambda: "") -> Iterator[Result]:
    """The results; stderr tells how many of the `whole` have been taken, and what `about` says of them."""
    start = shown = perf_counter()
    terminal = sys.stderr.isatty()
    for done, result in enumerate(results, start=1):
        yield result
        now = perf_counter()
        due = now - shown > PAUSE if terminal else done * LINES // whole > (done - 1) * LINES // whole
        if due or done == whole:
            shown = now
            left = (now - start) / done * (whole - done)
            text = f"{done} of {whole}, {about()}{now - start:.0f} s, {left:.0f} s left"
            end = "" if terminal and done < whole else "\n"
            print(f"\r{text:<90}" if terminal else text, end=end, file=sys.stderr, flush=True)
