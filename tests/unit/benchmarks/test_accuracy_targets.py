"""On some scenes of the accuracy benchmark near_edge reaches its targets, and the paper's methods are far from them."""

from functools import cache

import pytest

from benchmarks.accuracy.cases import some_cases
from benchmarks.accuracy.frames import KNOWN, TRACKED, UNKNOWN
from benchmarks.accuracy.measure import measure
from benchmarks.accuracy.setups import LEVEL, MOUNTED

CASES = some_cases(40, seed=1, setups=(LEVEL, MOUNTED))
OTHERS = ("rolled", "border")
TRACKED_PLANE = f"{UNKNOWN}, {TRACKED}"
PLANES = (KNOWN, TRACKED_PLANE)


@cache
def table(measured):
    """What near_edge and the paper's methods come to where the plane is known, or unknown and tracked."""
    return measure(CASES, ["near_edge", "paper", "virtual_floor"], [measured])


def figures(scan, plane, group="level"):
    return table(plane.partition(",")[0]).figures(scan, group, plane)


@pytest.mark.parametrize("plane", PLANES)
def test_near_edge_reaches_its_targets(plane):
    ours = figures("near_edge", plane)
    assert ours.found >= 0.99
    assert ours.late <= 0.001
    assert ours.false_safe <= 0.001
    assert ours.false_drop <= 0.001
    assert ours.relative95 <= 1.1
    assert ours.kerb >= 0.99
    assert ours.clear_beyond <= 0.003


@pytest.mark.parametrize("plane", PLANES)
def test_cameras_at_any_mount_are_nearly_as_good(plane):
    ours = figures("near_edge", plane, "mounted")
    assert ours.found >= 0.98
    assert ours.late <= 0.001
    assert ours.false_safe <= 0.001
    assert ours.relative95 <= 1.6


def test_cameras_at_any_roll_and_with_an_empty_border_are_as_good():
    cases = some_cases(160, seed=1, setups=OTHERS)
    found = measure(cases, ["near_edge"])
    for group in OTHERS:
        ours = found.figures("near_edge", group)
        assert ours.found >= 0.98
        assert ours.late <= 0.001
        assert ours.false_safe <= 0.001
        assert ours.blind <= 0.005
        assert ours.relative95 <= 1.6


@pytest.mark.parametrize("plane", PLANES)
def test_the_papers_methods_are_far_from_them(plane):
    paper, virtual_floor = figures("paper", plane), figures("virtual_floor", plane)
    assert paper.late > 0.1
    assert paper.false_safe > 0.9  # the farthest floor point is an obstacle on any open floor
    assert paper.percentile95 > 0.3  # [m]
    assert virtual_floor.found < 0.7
    assert virtual_floor.late > 0.1


def test_a_plane_that_is_a_little_wrong_and_not_tracked_is_worse_for_the_paper_than_for_near_edge():
    ours, paper = (figures(scan, UNKNOWN) for scan in ("near_edge", "paper"))
    assert ours.found > 0.95
    assert ours.late < 0.01
    assert ours.false_safe < 0.03
    assert paper.found < 0.7
    assert paper.late > 0.3
