"""A thinned image shows what matters where it is, to everybody who receives it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.common.contract.depth_codec import LEVELS, RAW, encode
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.capture.thinning import thinned
from cliffscan.services.perception.perceive import Settings, perceive
from tests import scenes

ROBOT = 0.42  # [m]
EVERY = 2, 3
MOUNTS = {
    "level": FloorPlane.from_mount(0.30),
    "down": FloorPlane.from_mount(0.6, math.radians(25)),
    "rolled": FloorPlane.from_mount(0.4, 0.1, math.radians(30)),
    "on its side": FloorPlane.from_mount(0.5, 0.2, math.radians(90)),
}


def camera(mount):
    return scenes.camera(640, 480, MOUNTS[mount], (0.5, 4.5))


def scans(depth, camera):
    return perceive(DepthImage.pack(0, 1, "", depth, camera, RAW), Settings())


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("every", EVERY)
@pytest.mark.parametrize("seen", [None, Region(7, 5, 630, 470)])
def test_what_is_higher_than_the_robot_is_in_no_scan(mount, every, seen):
    whole = replace(camera(mount), seen=seen)
    depth = scenes.depth(whole, [scenes.HOLE], wall=3.0)
    part, of_part = thinned(depth, whole, every, ROBOT)
    all_of_it, of_all = thinned(depth, whole, every, math.inf)
    assert mount != "level" or part.size < 0.9 * all_of_it.size
    for found, right in zip(scans(part, of_part)[::3], scans(all_of_it, of_all)[::3], strict=True):
        for field in ("ranges", "intensities", "clear"):
            np.testing.assert_array_equal(getattr(found, field), getattr(right, field))


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("every", EVERY)
def test_a_thinned_image_is_a_part_of_that_and_shows_the_same_edge(mount, every):
    whole = camera(mount)
    depth = scenes.depth(whole, [scenes.HOLE], wall=3.0)
    part, of_part = thinned(depth, whole, every, ROBOT)
    assert part.shape == (of_part.height, of_part.width)
    assert part.size <= depth.size / every + max(depth.shape)
    found, right = scans(part, of_part).negative.ranges, scans(depth, whole).negative.ranges
    both = np.isfinite(found) & np.isfinite(right)
    assert both.sum() > 0.9 * np.isfinite(right).sum()
    assert np.percentile(np.abs(found[both] - right[both]), 95) < 0.03


@pytest.mark.parametrize("mount", ["level", "on its side"])
@pytest.mark.parametrize("every", EVERY)
def test_every_pixel_keeps_its_ray(mount, every):
    """Of a surface that turns away no two columns measure the same, and the mean of three is the middle one."""
    whole = replace(camera(mount), noise=1e-3)
    level, some = mount == "level", 60
    inverse = 0.25 + 2.0 * whole.noise * np.arange(640 if level else 480)
    at = np.round(1e3 / inverse).astype(np.uint16)
    depth = np.tile(at, (480, 1)) if level else np.tile(at[:, None], (1, 640))
    part, of_part = thinned(depth, whole, every, math.inf)
    kept = 1e3 / (part[0] if level else part[:, 0])[: some // every]
    off = (kept - inverse[1::every][: len(kept)]) / whole.noise
    assert np.abs(off).max() < 1.3
    assert abs(off.mean()) < 0.3
    axis = slice(0, None, 2) if level else slice(1, None, 2)
    (focal, centre), (small_focal, small_centre) = whole.intrinsics[axis], of_part.intrinsics[axis]
    assert (1 + 5 * every - centre) / focal == pytest.approx((5 - small_centre) / small_focal)


@pytest.mark.parametrize("mount", ["level", "down", "on its side"])
@pytest.mark.parametrize("every", EVERY)
def test_a_leg_as_narrow_as_a_pixel_stands_in_the_way_wherever_it_falls(mount, every):
    whole = camera(mount)
    for shift in range(every):
        depth = scenes.depth(whole, wall=3.0)
        across = 300 + shift
        if mount == "on its side":
            depth[across] = np.minimum(depth[across], 1200)
        else:
            depth[:, across] = np.minimum(depth[:, across], 1200)
        found = scans(*thinned(depth, whole, every, ROBOT)).positive.ranges
        right = scans(depth, whole).positive.ranges
        stands = np.isfinite(right) & (right < 2.0)
        assert stands.any()
        assert (found[stands] < right[stands] + 0.03).all()


@pytest.mark.parametrize("every", EVERY)
def test_what_neighbours_measured_alike_is_averaged_and_no_further_than_the_noise_away(every):
    whole = camera("level")
    exact = scenes.depth(whole, wall=3.0).astype(float)
    inverse = 1.0 / (exact * 1e-3) + np.random.default_rng(5).normal(0.0, whole.noise, exact.shape)
    noisy = np.round(1e3 / inverse).astype(np.uint16)
    part, _ = thinned(noisy, whole, every, math.inf)
    true = 1e3 / exact[:, 1::every][:, : part.shape[1]]
    error = np.abs(1e3 / part - true) / whole.noise
    assert np.sqrt(np.mean(error**2)) < 1.2
    assert np.percentile(error, 99.9) < 4.0
    assert len(encode(part, LEVELS)) < 0.4 * len(encode(np.ascontiguousarray(noisy[:, 1::every]), LEVELS))


@pytest.mark.parametrize("every", EVERY)
def test_no_hole_is_filled(every):
    """Neither one that returns nothing nor one that shows its ground is covered by the floor beside it."""
    whole = camera("level")
    floor, depth = scenes.depth(whole, wall=3.0), scenes.depth(whole, [scenes.HOLE], wall=3.0)
    depth[:, 100:112] = 0
    part, _ = thinned(depth, whole, every, math.inf)
    below = slice(310, None)  # rows that show the floor, and nothing that stands
    own, flat = (image[below, 1::every][:, : part.shape[1]] for image in (depth, floor))
    part = part[below]
    assert (part[own == 0] == 0).all()
    assert (own == 0).any()
    deep = own > flat + 100
    assert deep.any()
    assert (part[deep] > 0.97 * own[deep]).all()


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("every", EVERY)
@pytest.mark.parametrize("lower_than", [0.02, ROBOT, math.inf])
def test_every_receiver_takes_it(mount, every, lower_than):
    whole = camera(mount)
    part, of_part = thinned(scenes.depth(whole), whole, every, lower_than)
    sent = DepthImage.pack(3, 7, "camera", part, of_part, LEVELS)
    received = DepthImage.decode(sent.encode())
    assert received.camera == of_part
    np.testing.assert_array_equal(received.depth, part)


def test_where_the_principal_point_would_lie_too_far_outside_all_rows_stay():
    up = scenes.camera(640, 480, FloorPlane.from_mount(0.3, math.radians(-20)), (0.5, 4.5))
    part, of_part = thinned(scenes.depth(up), up, 2, 0.05)
    assert of_part.height == 480
    assert part.shape == (480, 320)
