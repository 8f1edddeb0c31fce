"""Cases times plane modes times scans, the same rows however many processes share the work."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from functools import partial

from benchmarks.accuracy.cases import Case, scene_of
from benchmarks.accuracy.frames import KNOWN, WOBBLING, Frame, frames_of
from benchmarks.accuracy.rows import Census, Row, Table
from benchmarks.accuracy.scans import ANGLES, beams_of, known_scans
from benchmarks.accuracy.score import Tally
from benchmarks.accuracy.truth import Truth, truth_of

KERB_REACH = 1.5  # [m]
EVERY = 9  # of the cases, one in so many wobbles: a sequence takes as long as a dozen; no multiple of the kinds

Work = tuple[Case, str]
Progress = Callable[[int, int], None]


def measure(
    cases: Sequence[Case],
    scans: Sequence[str] | None = None,
    planes: Sequence[str] = (KNOWN,),
    jobs: int = 1,
    progress: Progress = lambda _done, _whole: None,
) -> Table:
    """Score scans, by default all, on cases in plane modes. progress is told how much of the work is done."""
    names = tuple(known_scans()) if scans is None else tuple(scans)
    work = [(case, plane) for plane in planes for case in (cases[::EVERY] if plane == WOBBLING else cases)]
    rows: list[Row] = []
    for done, found in enumerate(in_order(partial(results, scans=names), work, jobs), start=1):
        rows += found
        progress(done, len(work))
    return Table(tuple(rows))


def in_order(job: Callable[[Work], list[Row]], work: Sequence[Work], jobs: int) -> Iterator[list[Row]]:
    """What a job makes of each piece of work."""
    if jobs == 1 or len(work) < 2 * jobs:
        yield from map(job, work)
        return
    job(work[0])  # compiles the kernels once, before the processes part
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        yield from pool.imap(job, work, chunksize=2)


def results(work: Work, scans: Sequence[str]) -> list[Row]:
    """The rows of a case in a plane mode, one for each scan, with and without a tracked plane."""
    case, plane = work
    scene = scene_of(case)
    judged: dict[str, list[tuple[Frame, Truth]]] = {}
    for frame in frames_of(case, plane):
        judged.setdefault(frame.plane, []).append((frame, truth_of(scene, frame.true, ANGLES)))
    return [row for mode, frames in judged.items() for row in rows_of(case, mode, frames, scans)]


def rows_of(case: Case, plane: str, frames: Sequence[tuple[Frame, Truth]], scans: Sequence[str]) -> Iterator[Row]:
    """One row for each scan, over all frames."""
    census = Census.of([truth for _, truth in frames])
    seen = [(beams_of(frame, scans), truth) for frame, truth in frames]
    for scan in scans:
        tally = Tally.total([Tally.of(beams[scan], truth) for beams, truth in seen])
        kerb = Tally.total([Tally.of(beams[scan], near(truth)) for beams, truth in seen])
        yield Row(case, plane, scan, tally, kerb, census)


def near(truth: Truth) -> Truth:
    """The same truth with no drop beams beyond KERB_REACH."""
    return truth._replace(drop=truth.drop & (truth.edge <= KERB_REACH))
