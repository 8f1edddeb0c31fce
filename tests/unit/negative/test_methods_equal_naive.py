"""The fast scans equal the slow ones, for every scene and any camera."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cliffscan.common.contract.beam_grid import Grid
from cliffscan.common.contract.camera import FloorPlane, reach
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.negative.methods.farthest_point import farthest_point
from cliffscan.services.negative.methods.virtual_floor import virtual_floor
from cliffscan.services.positive.projection import projection
from tests import naive, naive_positive, scenes

BAND, ROBOT, SLOPE, NOISE = 0.03, 0.42, 0.12, 0.02
OFF_CENTRE = 1e-4  # [rad] so that no pixel lies exactly between two beams, where rounding alone decides
GRID = Grid.between(64, -math.radians(29), math.radians(29))


def assert_equal_naive(depth, camera, grid):
    low, all_heights = floor_points(depth, camera, lower_than=BAND), floor_points(depth, camera)
    low_enough = floor_points(depth, camera, lower_than=ROBOT)
    found = {
        "farthest_point": farthest_point(low, grid, BAND),
        "virtual_floor": virtual_floor(low, grid, BAND),
        "flat": projection(low_enough, grid, BAND, ROBOT, 0.0, 0.0),
        "ramps": projection(low_enough, grid, BAND, ROBOT, SLOPE, 0.0),
        "projection": projection(low_enough, grid, BAND, ROBOT, SLOPE, NOISE),
    }
    assert_array_equal(farthest_point(all_heights, grid, BAND), found["farthest_point"])
    assert_array_equal(virtual_floor(all_heights, grid, BAND), found["virtual_floor"])
    assert_array_equal(projection(all_heights, grid, BAND, ROBOT, SLOPE, NOISE), found["projection"])
    expected = {
        "farthest_point": naive.farthest_point(depth, camera, grid, BAND),
        "virtual_floor": naive.virtual_floor(depth, camera, grid, BAND),
        "flat": naive_positive.projection(depth, camera, grid, BAND, ROBOT),
        "ramps": naive_positive.projection(depth, camera, grid, BAND, ROBOT, SLOPE),
        "projection": naive_positive.projection(depth, camera, grid, BAND, ROBOT, SLOPE, NOISE),
    }
    for method, ranges in found.items():
        assert_allclose(ranges, expected[method], rtol=1e-6, err_msg=method)
    return found


@pytest.mark.parametrize("scene", scenes.SCENES)
@pytest.mark.parametrize("pitch", [0.0, 12.0, 35.0])
def test_scenes(scene, pitch):
    camera = scenes.camera(floor=FloorPlane.from_mount(0.3, math.radians(pitch)))
    assert_equal_naive(scenes.depth(camera, **scenes.SCENES[scene]), camera, GRID)


@settings(max_examples=15)
@given(
    st.floats(0.1, 1.5),
    st.floats(-20, 60),
    st.sampled_from([0.0, 3.0, -30.0, 89.0, 180.0, -100.0]),
    st.integers(5, 150),
    st.floats(10, 90),
    st.integers(0, 2**32 - 1),
)
def test_any_camera_any_grid_any_noise(height, pitch, roll, beams, view, seed):
    floor = FloorPlane.from_mount(height, math.radians(pitch), math.radians(roll))
    sideways = abs(roll) in (89.0, 100.0)
    camera = scenes.camera(24, 32, floor) if sideways else scenes.camera(32, 24, floor)
    depth = scenes.depth(camera, [scenes.HOLE], [(0.8, 0.0, 0.0, 1.0, 0.3, 0.6)])
    noise = np.random.default_rng(seed)
    depth = np.where(noise.random(depth.shape) < 0.2, noise.integers(0, 9000, depth.shape), depth).astype(np.uint16)
    half = math.radians(view) / 2
    grid = Grid.between(beams, -half + OFF_CENTRE, half + OFF_CENTRE)
    if not sideways:
        assert_equal_naive(depth, camera, grid)
        return
    upright = camera.__class__(  # the same camera with its image's axes exchanged, as `floor_points` looks at it
        camera.height,
        camera.width,
        camera.intrinsics.__class__(*(camera.intrinsics[i] for i in (1, 0, 3, 2))),
        camera.range,
        FloorPlane(floor.ny, floor.nx, floor.nz, floor.d),
    )
    seen = floor_points(depth, camera)
    mirror = Grid.between(beams, -grid.angle_max, -grid.angle_min)
    turned = np.ascontiguousarray(depth.T)
    mirrored = naive.farthest_point(turned, upright, mirror, BAND)[::-1]
    assert_allclose(farthest_point(seen, grid, BAND), mirrored, rtol=1e-6)
    mirrored = naive_positive.projection(turned, upright, mirror, BAND, ROBOT, SLOPE, NOISE)[::-1]
    assert_allclose(projection(seen, grid, BAND, ROBOT, SLOPE, NOISE), mirrored, rtol=1e-6)


def test_a_row_of_a_real_size_image_leaves_no_beam_empty():
    camera = scenes.camera(640, 480)
    seen = floor_points(scenes.depth(camera), camera, lower_than=BAND)
    grid = Grid.between(640, -math.radians(29), math.radians(29))
    assert np.isfinite(farthest_point(seen, grid, BAND)).all()


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_any_depths_give_lawful_ranges(seed):
    camera = scenes.camera(16, 12)
    noise = np.random.default_rng(seed)
    depth = noise.integers(0, 65536, (12, 16)).astype(np.uint16)
    found = assert_equal_naive(depth, camera, GRID)
    for ranges in found.values():
        numbers = ranges[np.isfinite(ranges)]
        assert (numbers > 0).all()
        assert (numbers <= reach(camera) * (1 + 1e-6)).all()
        assert not np.isneginf(ranges).any()
