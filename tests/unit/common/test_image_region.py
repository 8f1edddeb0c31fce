"""The part of an image that is looked at."""

import math

import numpy as np
import pytest

from cliffscan.common.perception.image_region import image_region
from tests.build import camera

IMAGE = np.arange(48 * 64, dtype=np.uint16).reshape(48, 64)


def test_everything_is_looked_at_when_anything_counts():
    region = image_region(camera(), math.inf)
    assert region.rows == slice(0, 48)
    assert region.shape == (48, 64)
    np.testing.assert_array_equal(region.of(IMAGE), IMAGE)


def test_a_level_camera_sees_what_is_low_in_its_lower_rows_only():
    region = image_region(camera(), 0.03)
    assert 24 < region.rows.start <= 28  # row 24 looks level; at 4.5 m a row is 78 mm
    assert region.rows.stop == 48
    np.testing.assert_array_equal(region.of(IMAGE), IMAGE[region.rows])


def test_a_camera_upside_down_sees_it_in_its_upper_rows():
    region = image_region(camera(mount=(0.3, 0.0, math.pi)), 0.03)
    assert region.rows.start == 0
    assert 20 <= region.rows.stop < 24


def test_what_is_looked_at_keeps_its_place_above_the_floor():
    whole, part = (image_region(camera(mount=(0.3, 0.1, 0.05)), limit) for limit in (math.inf, 0.03))
    for axis in ("forward", "left", "up"):
        expected = getattr(whole, axis).table()[part.rows]
        np.testing.assert_allclose(getattr(part, axis).table(), expected, atol=1e-12)


@pytest.mark.parametrize("roll", [90, -90])
def test_a_camera_on_its_side_is_looked_at_transposed(roll):
    region = image_region(camera(mount=(0.3, 0.0, math.radians(roll))), math.inf)
    assert region.transposed
    assert region.shape == (64, 48)
    np.testing.assert_array_equal(region.of(IMAGE), IMAGE.T)


@pytest.mark.parametrize("pitch", [-80, 0, 80])
def test_two_rows_are_looked_at_even_where_nothing_can_be_seen(pitch):
    region = image_region(camera(mount=(20.0, math.radians(pitch), 0.0), reach=(0.0, 0.001)), 0.03)
    assert region.shape[0] >= 2
