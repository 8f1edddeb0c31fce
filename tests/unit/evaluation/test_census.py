"""What scans report is counted beam by beam."""

import numpy as np

from evaluation.census import census

INF, NAN = np.inf, np.nan


def test_census_counts_every_beam_once():
    found = census(np.array([[1.0, 3.0, INF, NAN]], np.float32))
    assert found == (0.5, 0.25, 0.25, 2.0)
    assert np.isnan(census(np.array([[INF]])).median)
