"""Verdicts and figures on hand-made beams."""

import numpy as np
import pytest

from benchmarks.accuracy.rows import Figures, Sight
from cliffscan.common.contract.beam_fields import ABSENT, Beams
from evaluation.score import Tally, Verdict, judge
from evaluation.truth.beam_truth import Truth
from evaluation.truth.scene_truth import EARLY

INF, NAN = np.inf, np.nan


def scan(ranges, clear=ABSENT):
    return Beams(ranges=np.array(ranges), intensities=np.zeros(len(ranges)), clear=np.array(clear))


def truth(edge, allowed=0.02, drop=None, undecidable=None, sinking=None, earliest=None):
    """Beams with an edge [m] each, inf = none, that must be found if they are at most 3 m away."""
    edge = np.array(edge, dtype=float)
    none = np.zeros(len(edge), dtype=bool)
    return Truth(
        edge=edge,
        allowed=np.full(len(edge), allowed),
        earliest=edge - 2 * allowed - EARLY if earliest is None else np.array(earliest),
        drop=edge <= 3.0 if drop is None else np.array(drop),
        oblique=none,
        undecidable=none if undecidable is None else np.array(undecidable),
        sinking=none if sinking is None else np.array(sinking),
    )


@pytest.mark.parametrize(
    ("edge", "reported", "verdict"),
    [
        (2.0, 2.0, Verdict.FOUND),
        (2.0, 2.019, Verdict.FOUND),
        (2.0, 1.92, Verdict.FOUND),
        (2.0, 2.03, Verdict.LATE),
        (2.0, 1.90, Verdict.EARLY),
        (2.0, INF, Verdict.MISSED),
        (2.0, NAN, Verdict.MISSED),
        (INF, INF, Verdict.QUIET),
        (INF, NAN, Verdict.QUIET),
        (INF, 9.0, Verdict.FALSE),
        (4.0, 4.0, Verdict.UNCOUNTED),
        (4.0, 5.0, Verdict.UNCOUNTED),
        (4.0, NAN, Verdict.UNCOUNTED),
        (4.0, 3.0, Verdict.ASTRAY),
    ],
)
def test_verdict(edge, reported, verdict):
    assert judge(np.array([reported], dtype=np.float32), truth([edge])) == [verdict]


def test_number_where_a_ramp_is_out_of_sight_is_undecided_and_before_it_is_astray():
    ramp = truth([INF] * 3, undecidable=[True] * 3, sinking=[False, True, False], earliest=[2.0] * 3)
    assert list(judge(np.array([2.5, 2.5, 1.5]), ramp)) == [Verdict.UNCOUNTED, Verdict.UNCOUNTED, Verdict.ASTRAY]
    tally = Tally.of(scan([2.5, 2.5, 1.5]), ramp)
    assert (tally.hidden, tally.sinking) == (1, 1)


def test_errors_are_those_of_the_drop_beams_that_report_a_number():
    tally = Tally.of(scan([2.01, INF, 1.0, 4.5]), truth([2.0, 2.0, INF, 4.0]))
    assert tally.errors == pytest.approx([0.01])
    assert tally.relative == pytest.approx([0.5])


def test_floor_that_is_clear_beyond_the_edge_is_counted():
    told = scan([INF, NAN, 2.0, 2.0, INF], [2.5, 2.03, 2.019, 1.0, 4.0])
    figures = Figures.of([Tally.of(told, truth([2.0, 2.0, 2.0, 2.0, INF]))], [], [], [])
    assert figures.clear_beyond == 0.5


def test_figures():
    drops = [Tally.of(scan([2.0, 2.1, INF, 1.0, NAN, 1.0]), truth([2.0, 2.0, 2.0, 2.0, INF, INF]))]
    safe = [Tally.of(scan([INF, NAN, 4.0, INF]), truth([INF] * 4))]
    figures = Figures.of(drops, safe, [], [Sight(10, 1), Sight(30, 1)])
    assert figures.found == 0.5  # a number before the edge has found it, and is early besides
    assert (figures.missed, figures.late, figures.early) == (0.25, 0.25, 0.25)
    assert (figures.false_safe, figures.false_drop) == (0.25, 0.5)
    assert figures.median == pytest.approx(0.0)
    assert figures.blind == 0.05
    assert np.isnan(figures.kerb)
    assert np.isnan(figures.clear_beyond)


def test_total_of_nothing_is_nothing():
    assert Tally.total([]).count(*Verdict) == 0
    assert np.isnan(Figures.of([], [], [], []).found)
