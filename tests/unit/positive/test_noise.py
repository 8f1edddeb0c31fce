"""A flat floor is floor whatever the sensor's noise, and what is higher than the noise is an obstacle."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import KINECT_NOISE, Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.limits import LEAST_NOISE
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.scan import positive_scan
from tests import scenes

CONFIG = PositiveConfig()
STEREO_BASELINE = 0.05  # [m]
LOOKS = {0.3: 0.0, 1.0: 30.0}  # [deg] down, by the camera's height [m]


def stereo(height, focal=640.0, disparity=0.1):
    """A stereo camera at some height [m], whose disparities are off by `disparity` [px]."""
    floor = FloorPlane.from_mount(height, math.radians(LOOKS[height]))
    noise = disparity / (focal * STEREO_BASELINE)
    return Camera(640, 480, Intrinsics(focal, focal, 319.5, 239.5), (0.3, 6.0), floor, noise, STEREO_BASELINE)


def measured(camera, seed, **scene):
    """What a sensor with the camera's noise measures of a scene."""
    with np.errstate(divide="ignore"):
        inverse = 1000.0 / scenes.depth(camera, wall=60.0, **scene)
    inverse += np.random.default_rng(seed).normal(0.0, camera.noise, inverse.shape)
    depth = 1000.0 / np.maximum(inverse, 1e-3)
    millimetres = np.where(depth < 6000.0, np.round(depth), 0.0).astype(np.uint16)
    return DepthImage.pack(1, 1, "camera", millimetres, camera, RAW)


def in_the_way(image, config=CONFIG):
    return np.isfinite(positive_scan(image, config).ranges)


@pytest.mark.parametrize("height", LOOKS)
@pytest.mark.parametrize(("focal", "disparity"), [(640.0, 0.08), (640.0, 0.12), (900.0, 0.08), (900.0, 0.12)])
def test_a_flat_floor_is_free_whatever_the_noise(height, focal, disparity):
    camera = stereo(height, focal, disparity)
    false = [in_the_way(measured(camera, seed)).mean() for seed in range(3)]
    assert np.mean(false) <= 0.001


def test_a_sensor_that_tells_less_noise_than_it_has_sees_obstacles():
    image = measured(stereo(1.0), 1)
    boasting = DepthImage.pack(1, 1, "camera", image.depth, replace(image.camera, noise=LEAST_NOISE), RAW)
    assert in_the_way(boasting).mean() > 0.1  # so the tests above test something


def test_the_papers_floor_is_exact():
    image = measured(stereo(1.0), 1)
    exact = DepthImage.pack(1, 1, "camera", image.depth, replace(image.camera, noise=LEAST_NOISE), RAW)
    paper = PositiveConfig(**PositiveConfig.PROFILES["paper"])
    found, expected = (positive_scan(each, paper).ranges for each in (image, exact))
    np.testing.assert_array_equal(found, expected)
    assert np.isfinite(found).mean() > 0.1


def box(distance, height):
    return distance, -0.3, 0.0, distance + 0.3, 0.3, height


@pytest.mark.parametrize(
    ("height", "distance", "top"),
    [(0.3, 1.0, 0.04), (0.3, 3.0, 0.05), (0.3, 5.0, 0.06), (1.0, 1.0, 0.05), (1.0, 2.0, 0.055), (1.0, 3.0, 0.07)],
)
def test_what_rises_above_the_noise_of_stereo_is_in_the_way(height, distance, top):
    assert in_the_way(measured(stereo(height), 1, boxes=[box(distance, top)]))[300:340].all()


def test_a_kinect_at_its_usual_height_loses_nothing():
    kinect = scenes.camera(320, 240, FloorPlane.from_mount(0.3), reach=(0.5, 4.5))
    for distance in (1.0, 2.0, 3.0, 4.0):
        depth = scenes.depth(kinect, boxes=[box(distance, 0.04)])
        found, exact = (
            positive_scan(DepthImage.pack(1, 1, "camera", depth, replace(kinect, noise=noise), RAW), CONFIG).ranges
            for noise in (KINECT_NOISE, LEAST_NOISE)
        )
        np.testing.assert_array_equal(found, exact)
        assert found[320] == pytest.approx(distance, rel=0.02)
