"""Cases times plane modes times scans, the same rows however many processes share the work."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from benchmarks.accuracy.cases import Case, scene_of
from benchmarks.accuracy.frames import KNOWN, WOBBLING, Frame, as_sent, frames_of
from benchmarks.accuracy.rows import Census, Row, Sight, Table
from benchmarks.accuracy.scans import ANGLES, Others, all_beams, known_scans
from cliffscan.common.contract.beam_fields import Beams
from evaluation.scenes.safe import open_floor
from evaluation.score import Tally
from evaluation.truth.beam_truth import Truth
from evaluation.truth.scene_truth import truth_of
from evaluation.truth.sight import floor_in_sight
from evaluation.workers import counted, in_order

KERB_REACH = 1.5  # [m]
EMPTY = open_floor.__name__
EVERY = 9  # of the cases, one in so many wobbles: a sequence takes as long as a dozen; no multiple of the kinds

Work = tuple[Case, str]
NO_OTHERS: Others = {}


def measure(
    cases: Sequence[Case],
    scans: Sequence[str] | None = None,
    planes: Sequence[str] = (KNOWN,),
    jobs: int = 1,
    others: Others = NO_OTHERS,
    every: int = 1,
) -> Table:
    """Score scans, by default all of ours, on cases in plane modes; others' only where jobs is 1.

    every: of how many columns one is sent.
    """
    job = partial(results, scans=tuple(known_scans()) if scans is None else tuple(scans), others=others, every=every)
    work = [(case, plane) for plane in planes for case in (cases[::EVERY] if plane == WOBBLING else cases)]
    found = in_order(job, work, jobs, warm_up=lambda: job(work[0]))
    return Table(tuple(row for rows in counted(found, len(work)) for row in rows))


def results(work: Work, scans: Sequence[str], others: Others, every: int = 1) -> list[Row]:
    """The rows of a case in a plane mode, one for each scan, with and without a tracked plane."""
    case, plane = work
    scene = scene_of(case)
    judged: dict[str, list[tuple[Frame, Truth]]] = {}
    for frame in frames_of(case, plane):
        truth = truth_of(scene, frame.true, ANGLES, case.setup.lengths)
        judged.setdefault(frame.plane, []).append((as_sent(frame, every), truth))
    return [row for mode, frames in judged.items() for row in rows_of(case, mode, frames, scans, others)]


def rows_of(
    case: Case, plane: str, frames: Sequence[tuple[Frame, Truth]], scans: Sequence[str], others: Others
) -> Iterator[Row]:
    """One row for each scan, over all frames."""
    census = Census.of([truth for _, truth in frames])
    seen = [(frame, all_beams(frame, scans, others), truth) for frame, truth in frames]
    for scan in (*scans, *others):
        tally = Tally.total([Tally.of(beams[scan], truth) for _, beams, truth in seen])
        kerb = Tally.total([Tally.of(beams[scan], near(truth)) for _, beams, truth in seen])
        sight = Sight.total([sight_of(case, frame, beams[scan]) for frame, beams, _ in seen])
        yield Row(case, plane, scan, tally, kerb, census, sight)


def sight_of(case: Case, frame: Frame, beams: Beams) -> Sight:
    """Of a scene that is nothing but floor, how many beams could see it, and how many saw nothing."""
    if case.kind != EMPTY:
        return Sight()
    could = floor_in_sight(frame.true, ANGLES)
    return Sight(int(could.sum()), int(np.isnan(beams.ranges[could]).sum()))


def near(truth: Truth) -> Truth:
    """The same truth with no drop beams beyond KERB_REACH."""
    return truth._replace(drop=truth.drop & (truth.edge <= KERB_REACH))
