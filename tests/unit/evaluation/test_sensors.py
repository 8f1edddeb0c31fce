"""Stereo and time of flight: the noise that the camera tells, planes that stay planes, edges that are spoiled."""

import numpy as np
import pytest

from cliffscan.common.contract.camera import scan_axes
from cliffscan.simulator.kinect import KinectModel
from evaluation.sensors import stereo, time_of_flight
from evaluation.sensors.stereo import REACH, SMEARED

QUIET = KinectModel(dropout=0.0)
D435 = stereo.stereo_camera(640.0, 0.1, 0.5, 0.3, 0.0)
KINECT_V2 = time_of_flight.flight_camera(0.5, 0.3, 0.0)


def floor(camera):
    """Inverse depth [1/m] of a flat floor: (rows, cols), 0 where it is out of range."""
    _, _, up = scan_axes(camera)
    inverse = np.maximum(-up.table() / camera.floor.d, 0.0)
    return np.where(inverse > 1.0 / camera.range[1], inverse, 0.0).astype(np.float32)


def errors(measure, camera, seed=1):
    """Of each pixel of a flat floor 0.8 to 1.5 m away, the error of its inverse depth [1/m]; NaN elsewhere."""
    inverse = floor(camera)
    depth = measure(inverse, camera, QUIET, np.random.default_rng(seed)) * 1e-3
    looked_at = (inverse > 1 / 1.5) & (inverse < 1 / 0.8)
    assert (depth[looked_at] > 0.0).all()
    return np.where(looked_at, 1.0 / np.maximum(depth, 1e-3) - inverse, np.nan)


@pytest.mark.parametrize(
    ("measure", "camera"), [(stereo.measure, D435), (time_of_flight.measure, KINECT_V2)], ids=["stereo", "flight"]
)
def test_a_floor_stays_where_it_is_with_the_noise_that_the_camera_tells(measure, camera):
    off = errors(measure, camera)
    assert np.nanstd(off) == pytest.approx(camera.noise, rel=0.15)
    assert abs(np.nanmean(off)) < 0.1 * camera.noise


def test_neighbours_err_alike_in_stereo_and_each_for_itself_in_time_of_flight():
    for measure, camera, least, most in (
        (stereo.measure, D435, 0.6, 0.9),
        (time_of_flight.measure, KINECT_V2, -0.05, 0.05),
    ):
        off = errors(measure, camera)
        both = np.isfinite(off[1:]) & np.isfinite(off[:-1])
        assert least < np.corrcoef(off[1:][both], off[:-1][both])[0, 1] < most


@pytest.mark.parametrize(("disparity", "rows"), [(0.5 * SMEARED, 2 * REACH + 1), (1.5 * SMEARED, 0)])
def test_a_small_step_is_smeared_and_a_large_one_is_not(disparity, rows):
    step = SMEARED / (stereo.BASELINE * 640.0)
    inverse = np.full((60, 8), 0.5, np.float32)
    inverse[30:] += disparity / (stereo.BASELINE * 640.0)
    smeared = stereo.smear(inverse, step)
    between = (smeared[:, 4] > inverse[0, 4] + 1e-6) & (smeared[:, 4] < inverse[-1, 4] - 1e-6)
    assert between.sum() == max(rows - 1, 0)


def test_what_returns_nothing_smears_nothing():
    inverse = np.full((40, 8), 0.5, np.float32)
    inverse[20:] = 0.0
    assert np.array_equal(stereo.smear(inverse, 1.0)[:20], inverse[:20])


def test_pixels_fly_at_edges_alone():
    inverse = np.full((40, 200), 0.3, np.float32)
    inverse[20:] = 1.0
    flown = time_of_flight.fly(inverse, np.random.default_rng(1))
    assert np.unique(np.flatnonzero((flown != inverse).any(axis=1))).tolist() == [20]
    assert 0.3 <= flown[20].min() < flown[20].max() <= 1.0
    plane = floor(KINECT_V2)
    seen = (plane > 0.0).all(axis=1)
    assert np.array_equal(time_of_flight.fly(plane, np.random.default_rng(1))[seen][1:], plane[seen][1:])
