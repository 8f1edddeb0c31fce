"""The scan that a depth image becomes: its grid, its limits, and what lies beyond them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from cliffscan.common.contract.camera import reach
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.perception.combine import beams_with, within
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.common.perception.scans import WARMUP_IMAGE, ImageScanConfig, laser_scan
from tests.build import camera

INF, NAN = math.inf, math.nan
CONFIG = ImageScanConfig(beams=5, range_max=3.0)


def image(view=None, millimetres=2000):
    view = view or camera()
    depth = np.full((view.height, view.width), millimetres, np.uint16)
    return DepthImage.pack(11, 22, "camera", depth, view, RAW)


def heights(image, config):
    return floor_points(image.depth, image.camera, config.range_min)


def beams(*ranges):
    return beams_with(np.array(ranges, np.float32), 4)


def test_a_scan_tells_of_its_frame_and_its_grid():
    scan = laser_scan(image(), beams(1, 2, INF, NAN, 3), CONFIG)
    assert (scan.seq, scan.stamp, scan.frame) == (11, 22, "camera_footprint")
    assert scan.angle_min == pytest.approx(-math.radians(29))
    assert scan.angle_max == pytest.approx(math.radians(29))
    assert scan.angle_increment == pytest.approx(math.radians(58) / 4)
    assert (scan.range_min, scan.range_max, scan.time_increment) == (0.0, 3.0, 0.0)
    assert scan.scan_time == pytest.approx(1 / 30)


def test_the_scan_time_is_the_period_that_a_frame_tells():
    told = image().model_copy(update={"period": 0.1})
    assert laser_scan(told, beams(1, 2, INF, NAN, 3), CONFIG).scan_time == 0.1


def test_numbers_free_beams_and_unseen_ones_stay_what_they_are():
    scan = laser_scan(image(), beams(1, 2, INF, NAN, 3), CONFIG)
    assert_array_equal(scan.ranges, np.float32([1, 2, INF, NAN, 3]))
    assert_array_equal(scan.intensities, [4, 4, 0, 0, 4])


def test_nothing_beyond_range_max_is_reported():
    limited = within(beams(2.999, 3.0, 3.001, 50, NAN), 3.0)
    assert_array_equal(limited.ranges, np.float32([2.999, 3.0, INF, INF, NAN]))
    assert_array_equal(limited.intensities, [4, 4, 0, 0, 0])


def test_range_max_is_no_farther_than_the_sensor_reaches():
    view = camera(reach=(0.5, 2.0))
    scan = laser_scan(image(view), beams(1, 2, INF, NAN, 1), CONFIG)
    assert scan.range_max == CONFIG.reach(view) == pytest.approx(reach(view))
    assert laser_scan(image(camera()), beams(1, 2, INF, NAN, 1), CONFIG).range_max == 3.0
    assert ImageScanConfig(range_min=2.9, range_max=3.0).reach(view) == 2.9


def test_what_the_sensor_sees_at_the_end_of_its_reach_is_reported():
    view = camera(reach=(0.5, 2.0))
    corner = heights(image(view, 2000), CONFIG).distances.max()
    assert within(beams(corner), CONFIG.reach(view)).ranges[0] == np.float32(corner)


@given(st.lists(st.floats(0, 5, width=32) | st.sampled_from([NAN, INF]), min_size=5, max_size=5))
def test_a_scan_can_be_read_back(ranges):
    scan = laser_scan(image(), beams(*ranges), CONFIG)
    back = LaserScan.decode(scan.encode())
    assert_array_equal(back.ranges, scan.ranges)
    assert_array_equal(np.isfinite(back.ranges), back.intensities > 0)


@pytest.mark.parametrize("beams", [2, 640, 20_000])
@pytest.mark.parametrize("view", [1.2, 58.0, 179.9])
def test_the_grid_is_as_configured(beams, view):
    grid = ImageScanConfig(beams=beams, field_of_view=view).grid()
    assert grid.beams == beams
    assert grid.angle_max - grid.angle_min == pytest.approx(math.radians(view))
    assert grid.angle_max == -grid.angle_min


def test_points_nearer_than_range_min_are_left_out():
    near = heights(image(millimetres=600), ImageScanConfig(range_min=0.9))
    assert np.isnan(near.heights).all()
    assert np.isfinite(heights(image(millimetres=600), ImageScanConfig(range_min=0.5)).heights).all()


def test_the_blank_frame_is_a_frame():
    assert DepthImage.decode(WARMUP_IMAGE.encode()).camera == WARMUP_IMAGE.camera
    assert np.isnan(heights(WARMUP_IMAGE, ImageScanConfig()).heights).all()
