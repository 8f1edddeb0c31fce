"""A thinned image shows what matters where it is, to everybody who receives it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.common.contract.depth_codec import LEVELS, RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.capture import thinning
from cliffscan.services.capture.thinning import thinned
from cliffscan.services.perception.perceive import Settings, perceive
from tests import scenes

ROBOT = 0.42  # [m]
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
@pytest.mark.parametrize("seen", [None, Region(7, 5, 630, 470)])
def test_the_rows_that_are_left_out_are_in_no_scan(mount, seen, monkeypatch):
    monkeypatch.setattr(thinning, "EVERY", 1)
    whole = replace(camera(mount), seen=seen)
    depth = scenes.depth(whole, [scenes.HOLE], wall=3.0)
    part, of_part = thinned(depth, whole, ROBOT)
    assert mount != "level" or part.size < 0.9 * depth.size
    for found, right in zip(scans(part, of_part)[::3], scans(depth, whole)[::3], strict=True):
        for field in ("ranges", "intensities", "clear"):
            np.testing.assert_array_equal(getattr(found, field), getattr(right, field))


@pytest.mark.parametrize("mount", MOUNTS)
def test_a_thinned_image_is_half_of_that_and_shows_the_same_edge(mount):
    whole = camera(mount)
    depth = scenes.depth(whole, [scenes.HOLE], wall=3.0)
    part, of_part = thinned(depth, whole, ROBOT)
    assert part.shape == (of_part.height, of_part.width)
    assert part.size <= depth.size / 2 + max(depth.shape)
    found, right = scans(part, of_part).negative.ranges, scans(depth, whole).negative.ranges
    both = np.isfinite(found) & np.isfinite(right)
    assert both.sum() > 0.9 * np.isfinite(right).sum()
    assert np.percentile(np.abs(found[both] - right[both]), 95) < 0.03


def test_every_pixel_keeps_its_ray():
    whole = camera("level")
    depth = np.tile(np.arange(640, dtype=np.uint16), (480, 1))
    part, of_part = thinned(depth, whole, math.inf)
    np.testing.assert_array_equal(part[0], np.arange(0, 640, 2))
    fx, _, cx, _ = whole.intrinsics
    small_fx, _, small_cx, _ = of_part.intrinsics
    assert (part[0, 5] - cx) / fx == pytest.approx((5 - small_cx) / small_fx)


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("lower_than", [0.02, ROBOT, math.inf])
def test_every_receiver_takes_it(mount, lower_than):
    whole = camera(mount)
    part, of_part = thinned(scenes.depth(whole), whole, lower_than)
    sent = DepthImage.pack(3, 7, "camera", part, of_part, LEVELS)
    received = DepthImage.decode(sent.encode())
    assert received.camera == of_part
    np.testing.assert_array_equal(received.depth, part)


def test_where_the_principal_point_would_lie_too_far_outside_all_rows_stay():
    up = scenes.camera(640, 480, FloorPlane.from_mount(0.3, math.radians(-20)), (0.5, 4.5))
    part, of_part = thinned(scenes.depth(up), up, 0.05)
    assert of_part.height == 480
    assert part.shape == (480, 320)
