"""Low steps are told, whichever way they are seen; what is smooth, too low, narrow or overhead is none."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cliffscan.common.contract.camera import FloorPlane, Intrinsics, scan_axes
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.image_region import image_region
from cliffscan.common.perception.low_steps import NONE, Sight, follow, low_steps
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.perception.perceive import Scans, Settings, perceive
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.simulator.kinect import KinectModel, kinect_camera, measure, returns
from tests import naive_low_steps, scenes

ANGLES = Settings().positive.grid().angles()
SIGHT = Sight.of(image_region(kinect_camera(), math.inf), step=0.012, slope=0.12)
PITCHES = pytest.mark.parametrize("pitch", [0.0, 15.0])
STEPS = pytest.mark.parametrize("height", [0.015, 0.02, 0.025])
WAYS = pytest.mark.parametrize(
    ("heading", "distance"), [(0, 0.95), (0, 1.3), (45, 0.85), (-45, 0.85), (70, 0.45), (-70, 0.45)]
)


def seen(camera, depth, seed=1, plane=None, settings=Settings()) -> Scans:  # noqa: B008
    """The scans of what a noisy Kinect makes of an exact image; plane: the floor that its frame is said to have."""
    metres = np.where(depth > 0, depth / 1000, np.inf).astype(np.float32)
    noisy = measure(returns(metres, camera, KinectModel()), camera, KinectModel(), np.random.default_rng(seed))
    told = replace(camera, floor=plane or camera.floor)
    return perceive(DepthImage.pack(0, 0, "camera", noisy, told, RAW), settings)


def stepped(camera, heading, distance, height):
    """(rows, columns) [mm]: floor that is `height` [m] higher or lower beyond `distance` [m] along a heading [deg]."""
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    along = forward * math.cos(math.radians(heading)) + left * math.sin(math.radians(heading))
    with np.errstate(divide="ignore", invalid="ignore"):
        near = np.where(up < 0, -camera.floor.d / up, np.inf)
        far = np.where(up < 0, (height - camera.floor.d) / up, np.inf)
        face = np.where(along > 0, distance / along, np.inf)
        depth = np.where(near * along < distance, near, np.maximum(far, face))
    return np.round(1000 * np.where(depth < 60.0, depth, 0.0)).astype(np.uint16)


def step_at(heading, distance):
    """Where each beam crosses such a step [m], and which beams see it in 0.9 to 1.5 m: (beams,) each."""
    with np.errstate(divide="ignore"):
        at = distance / np.cos(ANGLES - math.radians(heading))
    return at, (at > 0.9) & (at < 1.5)


@PITCHES
@STEPS
@WAYS
def test_a_step_up_is_in_the_way_and_nothing_behind_it_is_free(pitch, height, heading, distance):
    camera = kinect_camera(0.3, math.radians(pitch))
    scans = seen(camera, stepped(camera, heading, distance, height))
    at, asked = step_at(heading, distance)
    assert asked.sum() > 50
    assert (np.abs(scans.positive.ranges - at) < 0.03)[asked].mean() > 0.95
    assert (scans.fused.clear < at + 0.03)[asked].mean() > 0.95


@PITCHES
@STEPS
@WAYS
def test_a_step_down_is_an_edge_where_the_floor_ends(pitch, height, heading, distance):
    camera = kinect_camera(0.3, math.radians(pitch))
    scan = seen(camera, stepped(camera, heading, distance, -height)).negative
    at, asked = step_at(heading, distance)
    told = (scan.ranges < at + 0.02) & (scan.ranges > at - 0.05)
    assert asked.sum() > 50
    assert told[asked].mean() > 0.9
    assert (scan.intensities[asked & told] == Evidence.DROP).all()


@PITCHES
@pytest.mark.parametrize("height", [0.009, -0.009])
@pytest.mark.parametrize("heading", [0, 45, 70])
def test_what_a_wheel_takes_is_floor(pitch, height, heading):
    camera = kinect_camera(0.3, math.radians(pitch))
    for seed in range(3):
        scans = seen(camera, stepped(camera, heading, 0.5 if heading == 70 else 1.0, height), seed)
        assert not np.isfinite(scans.fused.ranges).any()


def test_a_robot_with_larger_wheels_takes_more():
    camera = kinect_camera()
    large = Settings(NegativeConfig(wheel_step=0.024), PositiveConfig(wheel_step=0.024))
    image = stepped(camera, 0, 1.0, 0.02)
    assert np.isfinite(seen(camera, image).positive.ranges).mean() > 0.95
    assert not np.isfinite(seen(camera, image, settings=large).positive.ranges).any()


def test_the_papers_floor_band_hides_low_steps():
    camera = kinect_camera()
    positive = seen(camera, stepped(camera, 0, 1.0, 0.02), settings=Settings.of_profile("paper")).positive
    assert not np.isfinite(positive.ranges).any()


@pytest.mark.parametrize("degrees", [2.0, 5.0])
@pytest.mark.parametrize("foot", [0.3, 0.9, 1.2])
@PITCHES
def test_a_ramp_is_no_step(pitch, foot, degrees):
    camera = kinect_camera(0.3, math.radians(pitch))
    for seed in range(3):
        scans = seen(camera, scenes.depth(camera, wall=60.0, ramp=(foot, degrees)), seed)
        assert not np.isfinite(scans.fused.ranges).any()


@pytest.mark.parametrize("tilt", [1.0, -1.0])
@PITCHES
def test_a_floor_plane_that_is_wrong_by_a_degree_makes_no_step(pitch, tilt):
    camera = kinect_camera(0.3, math.radians(pitch))
    wrong = FloorPlane.from_mount(0.3, math.radians(pitch + tilt), math.radians(tilt))
    scans = seen(camera, scenes.depth(camera, wall=60.0), plane=wrong)
    blind = Settings(positive=PositiveConfig(wheel_step=0.0))
    without = seen(camera, scenes.depth(camera, wall=60.0), plane=wrong, settings=blind)
    np.testing.assert_array_equal(scans.positive.ranges, without.positive.ranges)
    assert not np.isfinite(scans.negative.ranges).any()


@pytest.mark.parametrize("thing", [(1.0, -2.0, 0.0, 1.015, 2.0, 0.015), (1.0, 0.0, 0.0, 1.5, 0.004, 0.02)])
def test_a_cable_and_a_speckle_are_no_steps(thing):
    camera = kinect_camera()
    assert not np.isfinite(seen(camera, scenes.depth(camera, boxes=[thing], wall=60.0)).fused.ranges).any()


def test_what_hangs_above_the_robot_is_no_step():
    camera = kinect_camera(1.0, math.radians(30))
    board = (0.9, -3.0, 0.55, 1.2, 3.0, 0.6)
    assert not np.isfinite(seen(camera, scenes.depth(camera, boxes=[board], wall=60.0)).positive.ranges).any()


def line(*stretches, spacing=0.012):
    """Heights and distances along a line, (rows, 1) each: stretches of a length and a height [m], from 0.75 m on."""
    heights = np.concatenate([np.full(round(length / spacing), height) for length, height in stretches])
    distances = 0.75 + spacing * np.arange(len(heights))
    return heights.astype(np.float32)[:, None], distances.astype(np.float32)[:, None]


def kind_of(heights, distances):
    return follow(heights, distances, np.arange(len(heights)), np.array([0]), SIGHT).kind[0]


def test_a_fall_after_less_floor_than_a_sills_width_is_none_unless_the_floor_began_in_view():
    assert kind_of(*line((0.3, 0.0), (0.3, -0.02))) == -1.0
    assert kind_of(*line((0.1, 0.0), (0.3, -0.02))) == -1.0
    assert kind_of(*line((0.3, 0.0), (0.02, 0.01), (0.1, 0.0), (0.3, -0.02))) == NONE
    assert kind_of(*line((0.1, 0.02), (0.3, 0.0))) == NONE  # the top of a thing


@pytest.mark.parametrize("roll", [0.0, 90.0])
def test_lines_that_are_left_out_shorten_no_reach(roll):
    camera = replace(kinect_camera(), floor=FloorPlane.from_mount(0.3, 0.0, math.radians(roll)))
    fx, fy, cx, cy = camera.intrinsics
    sparse = Intrinsics(fx, fy / 3, cx, cy / 3) if roll else Intrinsics(fx / 3, fy, cx / 3, cy)
    seen = [image_region(each, math.inf) for each in (camera, replace(camera, intrinsics=sparse))]
    whole, thin = (Sight.of(each, step=0.012, slope=0.12) for each in seen)
    assert thin == whole


def test_a_rough_floor_hides_what_it_may_be_itself():
    heights, distances = line((0.3, 0.0), (0.3, 0.02))
    rough = heights + 0.006 * np.resize([1.0, -1.0], len(heights)).astype(np.float32)[:, None]
    assert kind_of(heights, distances) == 1.0
    assert kind_of(rough, distances) == NONE


def test_a_frame_without_a_return_has_no_steps():
    heights = np.full((20, 40), np.nan, np.float32)
    assert not low_steps(heights, np.ones_like(heights), np.arange(20), SIGHT).kind.any()


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.02), st.floats(0.0, 0.3), st.integers(1, 6))
def test_the_kernel_equals_its_twin(seed, noise, lost, steps):
    random = np.random.default_rng(seed)
    rows, lines = 60, 9
    changes = np.zeros((rows, lines))
    changes[random.integers(0, rows, steps)] = random.uniform(-0.04, 0.04, (steps, lines))
    heights = np.cumsum(changes, axis=0) + noise * random.standard_normal((rows, lines)) * 0.2
    heights[random.random((rows, lines)) < lost] = np.nan
    distances = np.sort(random.uniform(0.7, 2.1, (rows, lines)), axis=0) + 0.002 * random.standard_normal((rows, lines))
    heights, distances = heights.astype(np.float32), distances.astype(np.float32)
    found = follow(heights, distances, np.arange(rows), np.arange(lines), SIGHT)
    for number in range(lines):
        step = naive_low_steps.first_step(heights[:, number], distances[:, number], SIGHT)
        assert found.kind[number] == (step.way if step else NONE)
        if step:
            assert (found.row[number], found.before[number]) == (step.row, step.before)
            np.testing.assert_allclose((found.level[number], found.distance[number]), step[3:], rtol=1e-5, atol=1e-7)
