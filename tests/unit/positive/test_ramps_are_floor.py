"""A ramp that may be driven is floor, from wherever the camera first sees it; what stands on it is not."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from common.depth_codec import RAW
from common.geometry import FloorPlane, scan_axes
from common.messages import DepthImage
from services.positive.__main__ import obstacles
from services.positive.config import PositiveConfig
from tests import scenes

CONFIG = PositiveConfig(beams=31)
FLAT = PositiveConfig(beams=31, **PositiveConfig.PROFILES["paper"])
LOOKS = pytest.mark.parametrize("look", [0.0, 12.0, 180.0])  # [deg] level, down, and level but upside down


def ranges_on_ramp(look, degrees, foot, config=CONFIG, boxes=(), noise=0.0):
    """What is found where a ramp rises at `foot` [m] before the camera, on which boxes stand."""
    pitch, roll = (0.0, math.pi) if look == 180.0 else (math.radians(look), 0.0)
    camera = scenes.camera(160, 120, FloorPlane.from_mount(0.3, pitch, roll))
    forward, _, up = (axis.table() for axis in scan_axes(camera))
    slope = math.tan(math.radians(degrees))
    with np.errstate(divide="ignore", invalid="ignore"):
        ramp = (camera.floor.d + slope * foot) / (slope * forward - up)
        ramp = np.where((ramp > 0) & (ramp * forward > foot), ramp, np.inf)
    depth = scenes.depth(camera, boxes=list(boxes), wall=60.0) / 1000.0
    depth = np.minimum(np.where(depth > 0.0, depth, np.inf), ramp)
    depth *= 1.0 + noise * depth * np.random.default_rng(1).normal(size=depth.shape)
    millimetres = np.where(depth < 4.5, np.round(depth * 1000.0), 0.0).astype(np.uint16)
    return obstacles(DepthImage.pack(1, 1, "camera", millimetres, camera, RAW), config).ranges


@LOOKS
@pytest.mark.parametrize("degrees", [2.0, 5.0])
@pytest.mark.parametrize("foot", [0.2, 0.36, 0.7, 1.0, 2.0])
def test_a_ramp_is_floor_wherever_its_foot_is(look, degrees, foot):
    assert np.isposinf(ranges_on_ramp(look, degrees, foot)).all()
    assert np.isposinf(ranges_on_ramp(look, degrees, foot, noise=1e-3)).all()


@LOOKS
def test_the_papers_floor_has_no_ramps(look):
    ranges = ranges_on_ramp(look, 5.0, 1.0, FLAT)
    assert_allclose(ranges[15], 1.0 + 0.03 / math.tan(math.radians(5.0)), rtol=0.03)


@LOOKS
@pytest.mark.parametrize("foot", [0.2, 1.0])
def test_what_is_too_steep_is_in_the_way(look, foot):
    assert np.isfinite(ranges_on_ramp(look, 12.0, foot)).all()


@LOOKS
@pytest.mark.parametrize("foot", [0.2, 1.0])
def test_what_stands_on_a_ramp_is_in_the_way(look, foot):
    beyond = 1.6
    height = (beyond - foot) * math.tan(math.radians(5.0)) + 0.06
    ranges = ranges_on_ramp(look, 5.0, foot, boxes=[(beyond, -0.2, 0.0, beyond + 0.2, 0.2, height)])
    assert ranges[15] == pytest.approx(beyond, rel=0.01)


@LOOKS
@pytest.mark.parametrize("height", [0.04, 0.05, 0.08])
@pytest.mark.parametrize("length", [0.4, 2.0])
def test_the_top_of_a_low_thing_is_no_ramp_where_its_face_is_not_seen(look, height, length):
    box = (0.3, -2.0, 0.0, 0.5 + length, 2.0, height)
    first_seen = ranges_on_ramp(look, 0.0, 60.0, boxes=[box])
    assert (first_seen < 0.75).all()
