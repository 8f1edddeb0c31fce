"""Scores, worked out by hand on a few beams."""

import numpy as np
import pytest

from cliffscan.common.contract.beam_fields import Beams
from evaluation.truth.beam_truth import Truth
from evaluation.truth.world_truth import TOLERANCE
from experiments import edges

INF, NAN = np.inf, np.nan


def truth(edge, obstacle=None, reachable=None):
    edge = np.array(edge)
    first = edge if obstacle is None else np.minimum(edge, obstacle)
    none = np.zeros(edge.shape, bool)
    drop = np.isfinite(edge) & (True if reachable is None else np.array(reachable))
    return Truth(edge, np.full(edge.shape, TOLERANCE), first - TOLERANCE, drop, none, none, none)


def score(ranges, truth):
    nothing = np.zeros(ranges.shape[1], np.float32)
    return edges.score([Beams(ranges=np.float32(row), intensities=nothing) for row in ranges], truth)


def test_error_is_reported_less_true_over_beams_with_an_edge_and_a_number():
    ranges = np.array([[1.0, 2.3, INF, NAN, 9.0], [1.2, 2.05, 3.0, NAN, 9.0]])
    found = score(ranges, truth([1.0, 2.0, 3.0, 4.0, INF], obstacle=[INF, INF, INF, INF, 9.0]))
    errors = [0.0, 0.3, 0.2, 0.05, 0.0]
    assert found.median == pytest.approx(np.median(errors))
    assert found.percentile95 == pytest.approx(np.percentile(errors, 95))
    assert found.missed == 3 / 8
    assert found.late == 2 / 8
    assert found.false == 0.0


def test_late_begins_beyond_the_tolerance():
    ranges = np.array([[1.0 + TOLERANCE - 1e-6, 1.0 + TOLERANCE + 1e-6]])
    assert score(ranges, truth([1.0, 1.0])).late == 0.5


def test_a_number_nearer_than_all_that_is_there_is_false_with_an_edge_and_without():
    edge, obstacle = [2.0, INF, INF, INF, 5.0], [3.0, 3.0, 3.0, INF, INF]
    ranges = np.array([[1.8, 2.8, 2.95, 4.0, 4.0]])
    found = score(ranges, truth(edge, obstacle))
    assert found.false == 4 / 5  # only 2.95 before an obstacle at 3.0 is right
    assert found.missed == found.late == 0.0


def test_an_edge_beyond_the_sensors_reach_is_nobodys_to_find_but_a_number_at_it_is_right():
    found = score(np.array([[5.95, 2.0]]), truth([6.0, 6.0], reachable=[False, False]))
    assert np.isnan([found.median, found.percentile95, found.missed, found.late]).all()
    assert found.false == 0.5


def test_free_and_unseen_beams_are_never_false_nor_late():
    found = score(np.array([[INF, NAN]]), truth([1.0, 1.0]))
    assert (found.missed, found.late, found.false) == (1.0, 0.0, 0.0)
    assert np.isnan(found.median)
