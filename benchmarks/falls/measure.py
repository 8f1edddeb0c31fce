"""Many runs, the same however many processes share the work."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator, Sequence
from functools import partial

from benchmarks.falls.cases import Case
from benchmarks.falls.outcome import Outcome
from benchmarks.falls.trial import Trial


def outcome_of(case: Case, metres: float) -> Outcome:
    """What comes of a run that lasts as long as a robot that is never held takes for that way [m]."""
    return Trial(case).run(metres / case.speed)


def measure(cases: Sequence[Case], metres: float, jobs: int) -> Iterator[Outcome]:
    """What comes of each run, in their order; metres as for outcome_of."""
    job = partial(outcome_of, metres=metres)
    if jobs == 1 or len(cases) < 2:
        yield from map(job, cases)
        return
    outcome_of(cases[0], 1.0)  # compiles the kernels once, before the processes part
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=50) as pool:
        yield from pool.imap(job, cases)
