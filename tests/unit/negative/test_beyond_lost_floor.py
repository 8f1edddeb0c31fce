"""What is seen beyond lost floor tells what it is: hidden by what is nearer; far off not known; near it counts.

A dark hole looks as a shine does, so it counts before it leaves the view.
"""

from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import Region
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.lost_floor import FAR_OFF, WAY
from cliffscan.services.negative.methods.near_edge import near_edge
from cliffscan.services.negative.scans import beams_by_method
from cliffscan.simulator.kinect import kinect_camera
from tests import naive, scenes
from tests.unit.negative.test_near_edge_floors import SEEDS, seen_by_kinect
from tests.unit.negative.test_near_edge_is_safe import floor_of

CONFIG = NegativeConfig()
CAMERA = kinect_camera()
AHEAD = np.cos(CONFIG.grid().angles())  # of a range [m] in each beam, how much leads ahead
MIDDLE = np.abs(CONFIG.grid().angles()) < 0.3


def dark(start: float, length: float, wide: float = 9.0, boxes=()) -> np.ndarray:
    """(rows, columns) [mm]: a floor that returns nothing in a patch, from x = start on."""
    distance, azimuth, _ = floor_of(CAMERA)
    x, y = distance * np.cos(azimuth), distance * np.sin(azimuth)
    depth = scenes.depth(CAMERA, boxes=list(boxes), wall=60.0)
    patch = (x > start) & (x < start + length) & (np.abs(y) < wide / 2)
    return np.where(patch & (depth >= scenes.depth(CAMERA, wall=60.0)), 0, depth).astype(np.uint16)


def found(millimetres, seed):
    return beams_by_method(seen_by_kinect(millimetres, CAMERA, seed), CONFIG, ["near_edge"])["near_edge"]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("length", [0.25, 0.4, 0.55])
@pytest.mark.parametrize("start", [0.95, 1.2, 1.5, 1.9])
def test_a_dark_patch_that_floor_is_seen_beyond_counts_while_it_is_near(start, length, seed):
    beams = found(dark(start, length), seed)
    assert (beams.intensities[MIDDLE] == Evidence.FLOOR_LOST).mean() > 0.99
    assert (np.abs(beams.ranges * AHEAD - start)[MIDDLE] < 0.1).mean() > 0.99


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("length", [0.25, 0.4])
@pytest.mark.parametrize("start", [2.2, 2.6])
def test_far_off_it_is_not_known_and_never_free(start, length, seed):
    beams = found(dark(start, length), seed)
    assert np.isnan(beams.ranges).mean() > 0.98
    assert (beams.clear * AHEAD < start + 0.1).all()
    assert (beams.clear * AHEAD > start - 0.2).mean() > 0.98


@pytest.mark.parametrize("seed", SEEDS)
def test_far_off_a_longer_patch_counts(seed):
    assert np.isfinite(found(dark(2.2, 0.9), seed).ranges).mean() > 0.95


def test_a_robot_sees_it_count_before_it_leaves_the_view():
    nearest = CAMERA.floor.d * CAMERA.intrinsics.fy / (CAMERA.height - 1 - CAMERA.intrinsics.cy)
    assert max(FAR_OFF, nearest + WAY) - nearest >= 1.0  # [m] of way


@pytest.mark.parametrize("seed", SEEDS)
def test_what_hangs_nearer_hides_it(seed):
    hanging = (1.4, -9.0, 0.08, 1.45, 9.0, 0.2)
    beams = found(dark(1.5, 0.45, boxes=[hanging]), seed)
    assert np.isnan(beams.ranges).mean() > 0.98


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("bottom", [0.27, 0.45])
def test_a_bar_of_a_railing_hides_no_edge(bottom, seed):
    bar = (1.4, -9.0, bottom, 1.45, 9.0, bottom + 0.05)
    beams = found(dark(1.5, 9.0, boxes=[bar]), seed)
    assert (beams.intensities[MIDDLE] == Evidence.FLOOR_LOST).mean() > 0.99


@pytest.mark.parametrize("seed", SEEDS)
def test_what_stands_beyond_does_not(seed):
    standing = (2.0, -9.0, 0.0, 2.2, 9.0, 0.4)
    beams = found(dark(1.5, 0.6, boxes=[standing]), seed)
    assert np.isfinite(beams.ranges[MIDDLE]).mean() > 0.98


@pytest.mark.parametrize(
    ("start", "length", "wide"), [(1.5, 0.4, 0.5), (2.4, 0.4, 0.08), (2.4, 0.4, 0.5), (2.2, 0.9, 0.5)]
)
def test_as_its_slow_twin(start, length, wide):
    strip = replace(CAMERA, seen=Region(300, 200, 339, 479))
    image = seen_by_kinect(dark(start, length, wide), strip, seed=7, dropout=0.05)
    points = floor_points(image.depth, strip, lower_than=CONFIG.floor_band)
    given = CONFIG.grid(), CONFIG.criteria(strip), "counts"
    fast, slow = near_edge(points, *given), naive.near_edge(points, *given)
    for mine, twins in zip((fast.ranges, fast.intensities, fast.clear), slow, strict=True):
        np.testing.assert_allclose(mine, twins, rtol=2e-5)
