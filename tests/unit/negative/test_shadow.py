"""What is lost beside something that stands is found to be its shadow, as the slow twin finds it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.common.contract.camera import Affine
from cliffscan.services.negative.shadow import shadowed
from tests import naive_trace

ROWS, COLUMNS = 24, 120
HEIGHT = np.float32(0.3)
FOCAL, BASELINE, NEAR = 115.0, 0.075, 0.5
DISPARITY = BASELINE * FOCAL
FLOOR, NONE = 0.0, math.nan


def rates(roll=0.0):
    """Of a level camera whose lowest row sees the floor 0.6 m away."""
    down = (np.arange(ROWS) + 58 - ROWS) / FOCAL
    aside = (np.arange(COLUMNS) - COLUMNS / 2) / FOCAL
    return Affine((math.sin(roll) * aside).astype(np.float32), (math.cos(roll) * down).astype(np.float32))


def both(heights, columns, rows, outward=-1, roll=0.0):
    """The fast answer, which is also the slow one."""
    seen = heights.astype(np.float32), rates(roll), HEIGHT
    fast = shadowed(*seen, np.array(columns), np.array(rows), outward, DISPARITY, NEAR)
    slow = [naive_trace.shadowed(*seen, c, r, outward, DISPARITY) for c, r in zip(columns, rows, strict=True)]
    assert fast.tolist() == slow
    return slow


def beside_a_post(shadow, foot=0.8, height=0.2):
    """Floor up to row 10, lost beyond it over so many columns to the left of a post that stands at column 60."""
    heights = np.full((ROWS, COLUMNS), FLOOR)
    heights[:, 60:64] = height - foot * 0.05
    heights[:, 60 - shadow : 60] = NONE
    return heights


def test_the_band_beside_a_post_is_its_shadow():
    assert both(beside_a_post(5), [55, 59], [10, 10]) == [True, True]


def test_a_band_wider_than_the_sensors_eyes_are_apart_is_not():
    assert both(beside_a_post(40), [21], [10]) == [False]


def test_a_hole_with_floor_between_it_and_the_post_is_not():
    heights = beside_a_post(0)
    heights[:10, 30:50] = NONE
    assert both(heights, [49], [10]) == [False]


def test_what_is_lost_before_floor_is_no_shadow():
    heights = beside_a_post(5, height=0.06)
    heights[:, 60:64] = FLOOR
    assert both(heights, [55], [10]) == [False]


@pytest.mark.parametrize("row", [0, 1, ROWS - 1])
def test_at_the_images_border_there_is_nothing_to_explain_it(row):
    assert both(beside_a_post(5), [55], [row]) == [row >= 2]


@given(
    st.floats(0.05, 0.9),
    st.floats(0.0, 0.6),
    st.floats(-0.3, 0.3),
    st.sampled_from([-1, 1]),
    st.integers(0, 2**32 - 1),
)
def test_any_image(lost, standing, roll, outward, seed):
    noise = np.random.default_rng(seed)
    heights = noise.normal(FLOOR, 0.01, (ROWS, COLUMNS))
    heights = np.where(noise.random(heights.shape) < standing, noise.uniform(0.02, 0.25, heights.shape), heights)
    down = rates(roll).columns + rates(roll).rows[:, None]
    heights[(noise.random(heights.shape) < lost) | (down <= 0) | (HEIGHT - heights < NEAR * down)] = NONE
    columns = noise.integers(0, COLUMNS, 30)
    both(heights, columns.tolist(), noise.integers(0, ROWS, 30).tolist(), outward, roll)
