"""The sensor model loses, blurs and rounds what the exact depth shows, by as much as it says."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator.faces import faces_of
from cliffscan.simulator.kinect import KinectModel, kinect_camera, measure, returns, sense
from cliffscan.simulator.rasteriser import depth_image
from cliffscan.simulator.world import World

CAMERA = kinect_camera()
SHAPE = (CAMERA.height, CAMERA.width)
IDEAL = KinectModel.ideal()


def flat(depth):
    """A wall square to the camera, depth [m] away."""
    return np.full(SHAPE, depth, dtype=np.float32)


def seen(name, camera=CAMERA):
    world = World(name)
    return depth_image(faces_of(world), *world.camera_pose(camera), camera)


def rng(seed=0):
    return np.random.default_rng(seed)


@given(depth=st.floats(0.5, 4.5, width=32))
def test_the_ideal_sensor_only_rounds(depth):
    frame = sense(flat(depth)[:12, :16], CAMERA, IDEAL, rng())
    assert frame.shape == (12, 16)
    assert np.abs(frame / 1000 - depth).max() <= 0.0005 + 1e-6


@pytest.mark.parametrize("depth", [0.49, 4.51, math.inf])
def test_nothing_is_measured_outside_the_range(depth):
    assert not sense(flat(depth), CAMERA, IDEAL, rng()).any()


@pytest.mark.parametrize("name", ["open_floor", "paper_room", "stairs_corridor"])
def test_every_measurement_is_within_the_range(name):
    frame = sense(seen(name), CAMERA, KinectModel(), rng())
    assert frame.dtype == np.uint16
    measured = frame[frame > 0]
    assert measured.min() >= 500
    assert measured.max() <= 4500


@pytest.mark.parametrize("depth", [1.0, 2.0, 4.0])
def test_noise_grows_with_the_square_of_the_depth(depth):
    frame = sense(flat(depth), CAMERA, replace(IDEAL, noise=1.425e-3), rng())
    assert frame.mean() / 1000 == pytest.approx(depth, rel=1e-4)
    assert math.sqrt(frame.std() ** 2 - 1 / 12) / 1000 == pytest.approx(1.425e-3 * depth**2, rel=0.02)


@pytest.mark.parametrize("depth", [1.0, 2.0, 4.0])
def test_depth_comes_in_steps_that_grow_with_its_square(depth):
    frame = sense(flat(depth), CAMERA, replace(KinectModel(), dropout=0.0), rng())
    levels = np.unique(frame) / 1000
    near = levels[np.abs(levels - depth) < 6e-3 * depth**2]
    assert len(near) >= 3
    np.testing.assert_allclose(np.diff(near), 2.85e-3 * depth**2, rtol=0.03, atol=1e-3)


def test_a_share_of_the_pixels_is_lost_at_random():
    frame = sense(flat(2.0), CAMERA, replace(IDEAL, dropout=0.2), rng())
    assert np.mean(frame == 0) == pytest.approx(0.2, abs=0.005)
    assert np.abs(np.mean(frame == 0, axis=0) - 0.2).max() < 0.12  # everywhere


def test_a_near_object_casts_a_shadow_to_its_left():
    """Its width is the difference of the disparities."""
    depth = flat(3.0)
    depth[100:300, 300:400] = 1.0
    lost = returns(depth, CAMERA, KinectModel()) == 0.0
    width = 0.075 * CAMERA.intrinsics.fx * (1 / 1.0 - 1 / 3.0)
    rows = lost[100:300]
    assert np.abs(rows.sum(axis=1) - width).max() <= 1.0
    assert (np.flatnonzero(rows[0]) < 300).all()
    assert rows[:, 299].all()
    assert not lost[:99].any()
    assert not lost[301:].any()


def test_what_is_infinitely_far_casts_no_shadow():
    depth = flat(3.0)
    depth[:, 300:400] = np.inf
    np.testing.assert_array_equal(returns(depth, CAMERA, KinectModel()) > 0.0, np.isfinite(depth))


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.05, 0.02), (-0.05, -0.03)])
def test_the_floor_in_range_is_not_lost_to_its_angle(tilt):
    camera = kinect_camera(0.30, *tilt)
    depth = seen("open_floor", camera)
    in_range = depth <= 4.5
    assert in_range.any()
    assert (returns(depth, camera, KinectModel())[in_range] > 0.0).all()


def test_a_surface_seen_edge_on_is_lost():
    """A floor is seen at the angle whose sine is height over distance: nothing returns beyond height / grazing."""
    camera = kinect_camera(0.30)
    depth = seen("open_floor", camera)
    kept = returns(depth, camera, replace(IDEAL, grazing=0.15)) > 0.0
    u, v = np.meshgrid(np.arange(SHAPE[1]), np.arange(SHAPE[0]))
    fx, fy, cx, cy = camera.intrinsics
    distance = depth * np.sqrt(((u - cx) / fx) ** 2 + ((v - cy) / fy) ** 2 + 1.0)
    inner = (slice(None), slice(1, -1))  # the outermost columns have a neighbour on one side only
    assert kept[inner][distance[inner] < 1.99].all()
    assert not kept[inner][distance[inner] > 2.01].any()


def test_an_object_in_front_of_another_is_not_taken_for_a_grazing_surface():
    depth = flat(4.0)
    depth[200:300, 300:303] = 0.6
    assert (returns(depth, CAMERA, replace(IDEAL, grazing=0.5))[200:300, 300:303] > 0.0).all()


def test_a_seed_gives_the_same_frames_again():
    inverse = returns(seen("paper_room"), CAMERA, KinectModel())
    once, again = rng(7), rng(7)
    first = [measure(inverse, CAMERA, KinectModel(), once) for _ in range(2)]
    second = [measure(inverse, CAMERA, KinectModel(), again) for _ in range(2)]
    np.testing.assert_array_equal(first, second)
    assert (first[0] != first[1]).any()
    assert (first[0] != measure(inverse, CAMERA, KinectModel(), rng(8))).any()


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("noise", -1.0),
        ("step", math.nan),
        ("baseline", math.inf),
        ("grazing", 1.0),
        ("dropout", -0.1),
        ("dropout", 1.0),
    ],
)
def test_a_model_that_means_nothing_is_refused(field, value):
    with pytest.raises(ValueError, match=field):
        KinectModel(**{field: value})


def test_the_camera_has_the_kinects_field_of_view():
    fx, fy, cx, cy = CAMERA.intrinsics
    assert 2 * math.degrees(math.atan(320 / fx)) == pytest.approx(58.0)
    assert 2 * math.degrees(math.atan(240 / fy)) == pytest.approx(45.0)
    assert (cx, cy) == (319.5, 239.5)
    assert CAMERA.floor == pytest.approx((0.0, -1.0, 0.0, 0.30))
