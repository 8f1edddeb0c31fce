"""What differs between two scans, beam by beam."""

import math

import numpy as np

from cliffscan.recording.scan_comparison import Tally, compare
from tests.build import scan

INF, NAN = math.inf, math.nan
TOLERANCE = 0.01


def found(then, now, field):
    return list(np.flatnonzero(getattr(compare(then, now, TOLERANCE), field)))


def made(ranges, intensities=None, clear=None):
    count = len(ranges)
    return scan(
        ranges, np.zeros(count) if intensities is None else intensities, [1.0] * count if clear is None else clear
    )


def test_a_scan_equals_itself():
    same = made([1.0, INF, NAN])
    difference = compare(same, same, 0.0)
    assert difference.equal.all()
    assert not difference.any.any()


def test_each_kind_of_difference_is_told_apart():
    then = made([1.0, 1.0, 1.0, INF, 2.0, INF, NAN, 1.0])
    now = made([1.0, 1.005, 1.02, 2.0, INF, NAN, INF, NAN])
    difference = compare(then, now, TOLERANCE)
    assert found(then, now, "equal") == [0]
    assert found(then, now, "moved") == [2]
    assert found(then, now, "appeared") == [3]
    assert found(then, now, "vanished") == [4, 7]
    assert found(then, now, "freed") == [5, 6]
    assert list(np.flatnonzero(difference.any)) == [2, 3, 4, 5, 6, 7]
    np.testing.assert_allclose(difference.by[:3], [0.0, 0.005, 0.02], atol=1e-6)


def test_evidence_and_clear_floor_count_too():
    then = made([1.0] * 4, [1, 2, 3, 4], [1.0, 1.0, 4.0, 1.0])
    now = made([1.0] * 4, [1, 3, 3, 4], [1.0, 1.2, 3.0, 1.0])
    assert found(then, now, "evidence") == [1]
    assert found(then, now, "longer") == [1]
    assert found(then, now, "shorter") == [2]
    assert found(then, now, "equal") == [0, 3]


def test_a_scan_without_clear_floor_is_taken_at_its_word():
    then, now = scan([1.0, NAN], [0, 0]), scan([1.0, NAN], [0, 0], [1.0, 0.0])
    difference = compare(then, now, TOLERANCE)
    assert not difference.any.any()
    assert not difference.equal.any()
    assert compare(then, then, TOLERANCE).equal.all()


def test_a_tally_adds_up():
    tally = Tally()
    same, other = made([1.0, 2.0]), made([1.5, 2.0])
    assert tally.add(compare(same, same, TOLERANCE)) == 0.0
    assert tally.add(compare(same, other, TOLERANCE)) == 0.5
    row = dict(zip(Tally.HEADINGS, tally.row("scan/fused"), strict=True))
    assert (row["scans"], row["beams"], row["equal"], row["moved"], row["by at most"]) == (
        "2",
        "4",
        "75.00 %",
        "1",
        "0.500 m",
    )
