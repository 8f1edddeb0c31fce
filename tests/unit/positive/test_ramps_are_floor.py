"""A ramp that may be driven is floor, from wherever the camera first sees it; what stands on it is not."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.scan import positive_scan
from tests import scenes

CONFIG = PositiveConfig(beams=31)
FLAT = PositiveConfig(beams=31, **PositiveConfig.PROFILES["paper"])
LOOKS = pytest.mark.parametrize("look", [0.0, 12.0, 180.0])  # [deg] level, down, and level but upside down


def ranges_on_ramp(look, degrees, foot, config=CONFIG, boxes=(), noise=0.0):
    """What is found where a ramp rises at `foot` [m] before the camera, on which boxes stand."""
    pitch, roll = (0.0, math.pi) if look == 180.0 else (math.radians(look), 0.0)
    camera = scenes.camera(160, 120, FloorPlane.from_mount(0.3, pitch, roll))
    depth = scenes.depth(camera, boxes=list(boxes), wall=60.0, ramp=(foot, degrees)) / 1000.0
    depth *= 1.0 + noise * depth * np.random.default_rng(1).normal(size=depth.shape)
    millimetres = np.where(depth < 4.5, np.round(depth * 1000.0), 0.0).astype(np.uint16)
    return positive_scan(DepthImage.pack(1, 1, "camera", millimetres, camera, RAW), config).ranges


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


def narrow(pitch=0.0):
    """A Kinect, 0.3 m above the floor and pitched [deg], of which there are only a few columns."""
    lens = Intrinsics(577.0, 577.0, 3.5, 239.5)
    return Camera(8, 480, lens, (0.4, 6.0), FloorPlane.from_mount(0.3, math.radians(pitch)))


def both(camera, **scene):
    """What is found by default, and on a flat floor, in the beams of a narrow camera."""
    image = DepthImage.pack(1, 1, "camera", scenes.depth(camera, wall=60.0, **scene), camera, RAW)
    values = {"beams": 3, "field_of_view": 0.4}
    default, flat = (PositiveConfig(**values, steepest=steepest) for steepest in (5.0, 0.0))
    return positive_scan(image, default).ranges, positive_scan(image, flat).ranges


@pytest.mark.parametrize("pitch", [-20.0, -15.0, -10.0, 0.0, 12.0])
@pytest.mark.parametrize("height", [0.04, 0.05, 0.06, 0.08, 0.12, 0.2])
def test_a_box_stays_in_the_way_while_the_robot_comes_near(pitch, height):
    for face in np.arange(0.35, 3.0, 0.015):
        found, flat = both(narrow(pitch), boxes=[(face, -0.3, 0.0, face + 1.0, 0.3, height)])
        assert (found <= flat + 0.05).all() or np.isnan(flat).all(), face


@pytest.mark.parametrize(("height", "tread"), [(0.025, 0.25), (0.029, 0.3), (0.04, 0.3)])
def test_low_steps_up_are_no_ramp(height, tread):
    found, flat = both(narrow(), boxes=[(1.0 + tread * n, -2.0, 0.0, 9.0, 2.0, height * (n + 1)) for n in range(6)])
    assert_allclose(found, flat, atol=0.01)


@pytest.mark.parametrize(("degrees", "height"), [(10.0, 0.08), (12.0, 0.06), (15.0, 0.05), (30.0, 0.04)])
def test_a_wedge_that_is_steeper_than_a_ramp_is_in_the_way(degrees, height):
    length, parts = height / math.tan(math.radians(degrees)), 60
    slices = [(1.2 + length * n / parts, -2.0, 0.0, 9.0, 2.0, height * (n + 1) / parts) for n in range(parts)]
    found, _ = both(narrow(), boxes=slices)
    assert (found <= 1.2 + length).all()
