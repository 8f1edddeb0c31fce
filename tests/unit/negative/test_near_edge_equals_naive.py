"""near_edge equals its slow twin, for every scene, any camera and however lost floor is to count."""

import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods.near_edge import FloorLost, near_edge
from tests import naive, scenes

CONFIG = NegativeConfig()
LOST = get_args(FloorLost)


def assert_equal_naive(depth, camera, floor_lost="counts", beams=64, off=0.0):
    half = math.radians(29)
    grid = Grid.between(beams, -half + off, half + off)
    seen = floor_points(depth, camera, lower_than=CONFIG.floor_band)
    found = near_edge(seen, grid, CONFIG.criteria(camera), floor_lost)
    ranges, evidence, clear = naive.near_edge(seen, grid, CONFIG.criteria(camera), floor_lost)
    assert_allclose(found.ranges, ranges, rtol=2e-5)
    assert_array_equal(found.intensities, evidence)
    assert_allclose(found.clear, clear, rtol=2e-5)
    return found


@pytest.mark.parametrize("floor_lost", LOST)
@pytest.mark.parametrize("mount", [(0.3, 0, 0), (0.45, 20, 0), (0.3, 5, 3), (0.3, 10, 180), (0.4, 15, 90)])
@pytest.mark.parametrize("scene", scenes.SCENES)
def test_scenes(scene, mount, floor_lost):
    camera = scenes.camera(64, 48, FloorPlane.from_mount(mount[0], *np.radians(mount[1:])))
    depth = scenes.depth(camera, **scenes.SCENES[scene])
    depth[:, 20:30] = np.where(depth[:, 20:30] < 2500, depth[:, 20:30], 0)
    assert_equal_naive(depth, camera, floor_lost)


@settings(max_examples=40)
@given(
    st.floats(0.15, 1.2),
    st.floats(0, 35),
    st.sampled_from([0.0, 3.0, -20.0, 90.0, 180.0]),
    st.floats(0, 0.4),
    st.sampled_from(LOST),
    st.integers(5, 200),
    st.integers(0, 2**32 - 1),
)
def test_any_camera_any_grid_any_noise(height, pitch, roll, lost, floor_lost, beams, seed):
    camera = scenes.camera(48, 36, FloorPlane.from_mount(height, math.radians(pitch), math.radians(roll)))
    depth = scenes.depth(camera, [scenes.HOLE], [(0.8, 0.0, 0.0, 1.0, 0.3, 0.6)])
    noise = np.random.default_rng(seed)
    depth = depth * (1.0 + 0.002 * noise.standard_normal(depth.shape))
    depth[noise.random(depth.shape) < lost] = 0
    assert_equal_naive(np.clip(depth, 0, 65535).astype(np.uint16), camera, floor_lost, beams, off=1e-4)
