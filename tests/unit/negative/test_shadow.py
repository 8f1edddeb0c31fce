"""What is lost beside something that stands is found to be its shadow, as the slow twin finds it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cliffscan.common.contract.camera import FloorPlane, scan_axes
from cliffscan.services.negative.shadow import shadowed
from tests import naive_trace, scenes

CAMERA = scenes.camera(120, 90, reach=(0.5, 6.0))
FOOT = 0.8  # [m] where the post stands, and where floor is lost behind it
LOST = 2.0


def both(depth, camera, pixels, outward=-1):
    """The fast answer, which is also the slow one."""
    last = np.array(pixels)
    beyond = last + np.array([2 * outward, 0])
    near, far = (int(limit * 1000) for limit in camera.range)
    _, _, up = scan_axes(camera)
    disparity = camera.baseline * camera.intrinsics.fx
    fast = shadowed(depth, near, far, up, camera.floor.d, last, beyond, disparity)
    slow = [naive_trace.shadowed(camera, depth, *pair) for pair in zip(last, beyond, strict=True)]
    assert fast.tolist() == slow
    return slow


def beside_a_post(shadow, height=0.2):
    """A floor with a post from column 60 on, and no return of so many columns to the left of it."""
    camera = CAMERA
    forward, left, _ = (axis.table() for axis in scan_axes(camera))
    side = (left / forward)[0, 60] * FOOT  # left of it
    depth = scenes.depth(camera, boxes=[(FOOT, side - 0.1, 0.0, FOOT + 0.05, side, height)], wall=60.0)
    depth[:, 60 - shadow : 60] = 0
    return depth


ROW = round(CAMERA.intrinsics.cy + CAMERA.intrinsics.fy * 0.3 / LOST)  # in which the post is seen as well


def test_the_band_beside_a_post_is_its_shadow():
    assert both(beside_a_post(5), CAMERA, [(ROW, 55), (ROW, 59)]) == [True, True]


def test_a_band_wider_than_the_sensors_eyes_are_apart_is_not():
    assert both(beside_a_post(40), CAMERA, [(ROW, 21)]) == [False]


def test_a_hole_with_floor_between_it_and_the_post_is_not():
    depth = beside_a_post(0)
    depth[:ROW, 30:50] = 0
    assert both(depth, CAMERA, [(ROW, 49)]) == [False]


def test_what_is_lost_before_floor_is_no_shadow():
    assert both(beside_a_post(5, height=0.0), CAMERA, [(ROW, 55)]) == [False]


@pytest.mark.parametrize("row", [0, 1])
def test_at_the_images_border_there_is_nothing_to_explain_it(row):
    assert both(beside_a_post(5), CAMERA, [(row, 55)]) == [False]


@settings(max_examples=50)
@given(
    st.floats(0.05, 0.9),
    st.floats(0.0, 0.6),
    st.floats(-180, 180),
    st.sampled_from([-1, 1]),
    st.integers(0, 2**32 - 1),
)
def test_any_image(lost, standing, roll, outward, seed):
    camera = replace(CAMERA, floor=FloorPlane.from_mount(0.3, 0.1, math.radians(roll)))
    noise = np.random.default_rng(seed)
    depth = scenes.depth(camera).astype(float)
    depth = np.where(noise.random(depth.shape) < standing, depth * noise.uniform(0.7, 1.0, depth.shape), depth)
    depth[noise.random(depth.shape) < lost] = 0
    pixels = np.stack([noise.integers(0, 90, 30), noise.integers(0, 120, 30)], axis=1)
    both(depth.astype(np.uint16), camera, pixels, outward)
