"""A face that rises row by row as a ramp does ends the floor at its foot, and a ramp does not."""

from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import Region
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods.near_edge import near_edge
from cliffscan.services.negative.scans import beams_by_method
from cliffscan.simulator.kinect import kinect_camera
from tests import naive, scenes
from tests.unit.negative.test_near_edge_floors import SEEDS, ramp, seen_by_kinect

CONFIG = NegativeConfig()
CAMERA = kinect_camera()
AHEAD = np.cos(CONFIG.grid().angles())  # of a range [m] in each beam, how much leads ahead


def box(near: float, height: float) -> np.ndarray:
    """(rows, columns) [mm]: a floor with a box across it, 0.6 m long."""
    return scenes.depth(CAMERA, boxes=[(near, -9.0, 0.0, near + 0.6, 9.0, height)], wall=60.0)


def found(image: DepthImage):
    return beams_by_method(image, CONFIG, ["near_edge"])["near_edge"]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("height", [0.05, 0.07, 0.1])
@pytest.mark.parametrize("near", [0.9, 1.2, 1.8, 2.4])
def test_a_low_box_is_neither_floor_nor_does_a_drop_end_it(near, height, seed):
    beams = found(seen_by_kinect(box(near, height), CAMERA, seed))
    assert np.isnan(beams.ranges).mean() > 0.99


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("near", [1.8, 2.1, 2.4])
def test_floor_ends_at_the_foot_of_a_face_that_was_followed(near, seed):
    clear = found(seen_by_kinect(box(near, 0.05), CAMERA, seed)).clear * AHEAD
    assert (np.abs(clear - near) < 0.07).mean() > 0.99


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("degrees", [2.0, 4.0, 5.0])
def test_a_ramp_up_is_no_face(degrees, seed):
    beams = found(seen_by_kinect(ramp(CAMERA, 1.2, degrees), CAMERA, seed))
    assert (beams.clear * AHEAD > 2.4).mean() > 0.99


@pytest.mark.parametrize(("near", "height"), [(0.9, 0.05), (1.8, 0.03), (2.6, 0.05)])
def test_as_its_slow_twin(near, height):
    strip = replace(CAMERA, seen=Region(310, 200, 329, 479))
    image = seen_by_kinect(box(near, height), strip, seed=5, dropout=0.1)
    points = floor_points(image.depth, strip, lower_than=CONFIG.floor_band)
    given = CONFIG.grid(), CONFIG.criteria(strip), "counts"
    fast, slow = near_edge(points, *given), naive.near_edge(points, *given)
    for mine, twins in zip((fast.ranges, fast.intensities, fast.clear), slow, strict=True):
        np.testing.assert_allclose(mine, twins, rtol=2e-5)
    assert (fast.clear > 0.0).any()
