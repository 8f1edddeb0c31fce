"""What the robot lives by: near_edge tells no edge too far, and nothing free that was not seen."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from cliffscan.common.contract.camera import Affine, FloorPlane, scan_axes
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import combine
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.negative.scans import beams_by_method
from cliffscan.services.negative.shadow import shadowed
from tests import scenes

CONFIG = NegativeConfig()
ANGLES = CONFIG.grid().angles()
BLOCK = 0.2  # [m] of floor, more than least_gap
SIZES = st.integers(0, 2**32 - 1)


def mounted(height, pitch=0.0, roll=0.0, width=160, rows=120):
    return scenes.camera(width, rows, FloorPlane.from_mount(height, math.radians(pitch), math.radians(roll)))


def found(depth, camera, config=CONFIG):
    image = DepthImage.pack(0, 0, "camera", depth, camera, RAW)
    return beams_by_method(image, config, ["near_edge"])["near_edge"]


def floor_of(camera):
    """The floor's distance [m] and azimuth [rad] at every pixel; nan above the horizon."""
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    away = np.where(up < -1e-3, -camera.floor.d / np.minimum(up, -1e-3), np.nan)
    return np.hypot(forward, left) * away, np.arctan2(left, forward), away


def ending(camera, end, height, deep):
    """A floor that ends at `end` [m], and far below it goes on, or shows nothing."""
    depth = scenes.depth(camera, wall=60.0)
    beyond = ~(floor_of(camera)[0] <= end)
    depth[beyond] = (depth[beyond] * (1 + 0.6 / height)).clip(0, 60000) if deep else 0
    return depth


@settings(max_examples=40)
@given(st.floats(0.2, 1.0), st.floats(0, 35), st.sampled_from([0.0, 180.0]), st.floats(0, 1), st.booleans())
def test_no_edge_is_farther_than_the_last_row_of_floor(height, pitch, roll, share, deep):
    camera = mounted(height, pitch, roll)
    distance, _, away = floor_of(camera)
    first, last = (float(limit) for limit in np.nanpercentile(distance[(away > 0.4) & (away < 3.0)], (0, 100)))
    end = first + 0.4 + share * max(last - first - 0.8, 0.0)
    beams = found(ending(camera, end, height, deep), camera)
    row = end**2 / (camera.intrinsics.fy * height) * 2 + 0.02  # [m] on the floor: a pitched camera's rows lie oblique
    sees = np.isfinite(beams.ranges)
    assert (beams.ranges[sees] <= end + row).all()
    assert (beams.clear <= end + row).all()


@pytest.mark.parametrize("deep", [True, False])
@pytest.mark.parametrize("mount", [(0.3, 0, 0), (0.3, 20, 180), (0.5, 30, 0), (1.0, 35, 0)])
def test_an_edge_1_m_from_the_nearest_floor_is_seen(mount, deep):
    camera = mounted(*mount)
    distance, _, away = floor_of(camera)
    end = np.nanmin(distance[away > 0.4]) + 1.0
    assert np.isfinite(found(ending(camera, end, mount[0], deep), camera).ranges).mean() > 0.9


@settings(max_examples=60)
@given(
    st.floats(0.2, 1.0),
    st.floats(0, 30),
    st.sampled_from([0.0, 180.0]),
    st.floats(0, 1),
    st.floats(0, 1),
    st.floats(0.1, 0.5),
    st.sampled_from(["counts", "beside_drop", "ignored"]),
)
def test_a_beam_through_a_part_of_the_floor_that_was_not_seen_is_not_free(
    height, pitch, roll, near, aside, wide, floor_lost
):
    camera = mounted(height, pitch, roll)
    distance, azimuth, away = floor_of(camera)
    depth = scenes.depth(camera, wall=60.0)
    nearest = np.nanmin(np.where(away > 0.4, distance, np.nan), axis=0).max()
    start = nearest + near * (3.0 - nearest - BLOCK)
    spacing = (start + BLOCK) ** 2 / (camera.intrinsics.fy * height)
    length = max(BLOCK, 7 * spacing)
    assume(start + length < 3.2)
    middle = math.radians(-25 + 50 * aside)
    half = max(wide / 2, 3 * math.radians(58) / 160)
    depth[(distance > start) & (distance < start + length) & (abs(azimuth - middle) < half)] = 0
    beams = found(depth, camera, NegativeConfig(floor_lost=floor_lost))
    through = np.abs(ANGLES - middle) < half - 1.5 * math.radians(58) / 160
    through &= np.abs(ANGLES) < math.radians(28)  # farther aside a beam leaves the image, maybe within that part
    assert through.any()
    assert not np.isposinf(beams.ranges[through]).any()
    assert (beams.clear[through] <= start + spacing).all()


@pytest.mark.parametrize("deep", [True, False])
@pytest.mark.parametrize("roll", [-20.0, -10.0, -3.0, -1.0, 1.0, 3.0, 10.0, 20.0, 177.0])
@pytest.mark.parametrize(("height", "pitch"), [(0.3, 0.0), (0.5, 20.0)])
def test_floor_that_the_border_shows_beyond_a_hole_frees_nothing(height, pitch, roll, deep):
    camera = mounted(height, pitch, roll)
    distance, _, _ = floor_of(camera)
    end = distance[0 if abs(roll) > 90 else -1].max() + 0.2  # all floor below the image is nearer
    depth = scenes.depth(camera, wall=60.0)
    row = 2 * end**2 / (camera.intrinsics.fy * height) + 0.02  # [m] on the floor: those of a leaning camera lie oblique
    hole = (distance > end) & (distance < end + max(0.5, 4 * row))
    depth[hole] = depth[hole] * 2 if deep else 0
    beams = found(depth, camera)
    assert (beams.clear <= end + row).all()
    assert not np.isposinf(beams.ranges).any()


@pytest.mark.parametrize(
    ("height", "pitch", "roll"),
    [(0.3, 0.0, -20.0), (0.3, 0.0, -3.0), (0.3, 0.0, 3.0), (0.3, 0.0, 20.0), (0.65, 55.0, -52.0), (0.65, 55.0, 52.0)],
)
def test_a_line_at_the_border_is_free_as_far_as_the_lines_beside_it(height, pitch, roll):
    camera = mounted(height, pitch, roll)
    distance, azimuth, away = floor_of(camera)
    beams = found(scenes.depth(camera, wall=60.0), camera)
    seen = azimuth[(away > 0.4) & (distance < 3.0)]
    within = np.abs(ANGLES - (seen.min() + seen.max()) / 2) < (seen.max() - seen.min()) / 2 - 0.02
    assert np.isposinf(beams.ranges[within]).mean() > 0.995


@pytest.mark.parametrize("mount", [(0.3, 0, 0), (0.3, 20, 3), (0.5, 10, 180), (0.4, 10, 90), (0.4, 10, -90)])
def test_a_frame_without_returns_tells_nothing(mount):
    camera = mounted(*mount)
    beams = found(np.zeros((120, 160), np.uint16), camera)
    assert np.isnan(beams.ranges).all()
    assert not beams.intensities.any()
    assert not beams.clear.any()


@pytest.mark.parametrize("mount", [(0.3, 0, 0), (0.3, 20, 3), (0.5, 10, 180), (0.4, 10, 90), (0.4, 10, -90)])
def test_an_open_floor_is_free(mount):
    width, rows = (120, 160) if abs(mount[2]) == 90 else (160, 120)
    camera = mounted(*mount, width, rows)
    inner = NegativeConfig(field_of_view=40)
    beams = found(scenes.depth(camera, wall=60.0), camera, inner)
    assert np.isposinf(beams.ranges).all()
    assert (beams.clear > 0.8 * min(CONFIG.sight, mount[0] / CONFIG.grazing)).all()


@pytest.mark.parametrize("off", [1.0, 1.5, 2.0])
def test_before_an_obstacle_floor_is_clear_up_to_its_foot(off):
    beams = found(scenes.depth(mounted(0.3, 0), wall=off), mounted(0.3, 0))
    least = CONFIG.least_drop * off / 0.3  # [m] by which the floor behind what rises no higher seems farther off
    assert np.isnan(beams.ranges).all()
    assert (np.abs(beams.clear * np.cos(ANGLES) - off) < least + 0.1).all()


@settings(max_examples=60)
@given(st.floats(0.05, 20), st.floats(-80, 80), st.floats(-180, 180), st.sampled_from(["noise", "hole", "flat"]), SIZES)
def test_any_image_of_any_camera_gives_lawful_scans(height, pitch, roll, kind, seed):
    camera = mounted(height, pitch, roll, 24, 18)
    noise = np.random.default_rng(seed)
    depth = scenes.depth(camera, [scenes.HOLE] if kind == "hole" else [])
    if kind == "noise":
        depth = noise.integers(0, noise.integers(2, 65536), depth.shape).astype(np.uint16)
    depth[noise.random(depth.shape) < 0.1] = 0
    beams = found(depth, camera)
    numbers = np.isfinite(beams.ranges)
    assert (beams.ranges[numbers] > 0).all()
    assert (beams.ranges[numbers] <= CONFIG.reach(camera)).all()
    assert not np.isneginf(beams.ranges).any()
    assert set(beams.intensities) <= {Evidence.NOTHING, Evidence.DROP, Evidence.FLOOR_LOST}
    np.testing.assert_array_equal(numbers, beams.intensities > 0)
    assert ((beams.clear >= 0) & (beams.clear <= CONFIG.reach(camera))).all()
    assert (beams.clear[numbers] <= beams.ranges[numbers] * (1 + 1e-6)).all()


@settings(max_examples=30)
@given(st.floats(0, 35), st.floats(0, 0.6), st.permutations(list(METHODS)), SIZES)
def test_combining_it_with_others_never_hides_an_obstacle(pitch, lost, methods, seed):
    camera = mounted(0.3, pitch)
    depth = scenes.depth(camera, [scenes.HOLE])
    depth[np.random.default_rng(seed).random(depth.shape) < lost] = 0
    image = DepthImage.pack(0, 0, "camera", depth, camera, RAW)
    scans = list(beams_by_method(image, CONFIG, methods).values())
    together = combine(scans)
    for scan in scans:
        told = np.isfinite(scan.ranges)
        assert (together.ranges[told] <= scan.ranges[told]).all()
        assert not np.isposinf(together.ranges[np.isnan(scan.ranges)]).any()


@pytest.mark.parametrize("beams", [5, 9, 15, 31, 640])
def test_a_hole_between_the_middles_of_two_beams_is_told(beams):
    camera = mounted(0.3, 10, width=640, rows=480)
    config = NegativeConfig(beams=beams)
    right, left = config.grid().angles()[beams // 2 - 1 :][:2]
    aside = 1.5 * math.tan((right + left) / 2)
    depth = scenes.depth(camera, [(1.5, aside - 0.06, -0.5, 2.4, aside + 0.06, 0.0)], wall=60.0)
    assert np.isfinite(found(depth, camera, config).ranges[beams // 2 - 1 :][:2]).all()


@pytest.mark.parametrize("pitch", [0, 20, 35, 45, 60])
def test_no_beam_is_empty_merely_because_a_camera_looks_down(pitch):
    camera = mounted(1.0, pitch, width=640, rows=480)
    near = 1.0 / math.tan(math.radians(pitch + 18))
    depth = scenes.depth(camera, [(near, -0.3, -0.5, near + 0.6, 0.3, 0.0)], wall=60.0)
    on_hole = np.abs(np.tan(ANGLES) * near) < 0.25
    assert np.isfinite(found(depth, camera).ranges[on_hole]).all()


def test_what_stands_exactly_on_the_horizon_of_a_rolled_camera_costs_nothing():
    depth = np.zeros((6, 20), np.uint16)
    depth[:, 12] = 1000  # as high as the camera, where a ray is level
    up = Affine(np.where(np.arange(20) == 12, 0.1, 0.0), np.full(6, -0.1))
    one = shadowed(depth, 500, 4500, up, 0.3, np.array([[4, 10]]), np.array([[2, 10]]), 40.0)
    assert one.shape == (1,)


@pytest.mark.parametrize(
    ("height", "pitch", "start", "middle"),
    [(0.2672122748659079, 30.816103691334945, 0.6143253119255929, -0.22744306755398813),
     (0.5252082693985014, 32.748974041557425, 0.5019404182785919, 0.2816143553015266)],
)  # fmt: skip
def test_no_beam_is_free_between_two_columns_that_are_not(height, pitch, start, middle):
    camera = mounted(height, pitch, width=640, rows=480)
    distance, azimuth, _ = floor_of(camera)
    depth = scenes.depth(camera, wall=60.0)
    depth[(distance > start) & (distance < start + 0.4) & (abs(azimuth - middle) < 0.2)] = 0
    beams = found(depth, camera)
    between = np.abs(ANGLES - middle) < 0.195
    assert not np.isposinf(beams.ranges[between]).any()
    assert (beams.clear[between] <= start + 0.02).all()


@pytest.mark.parametrize("tilt", [-2.0, -1.0, 0.0, 1.0, 2.0])
def test_floor_is_clear_up_to_a_gap_however_it_goes_on_behind(tilt):
    camera = mounted(0.3, 0.0, width=640, rows=480)
    depth = scenes.depth(mounted(0.3, tilt, width=640, rows=480), wall=60.0)
    gap = (depth > 1150) & (depth < 1250)
    depth[gap] = 0
    clear = found(depth, camera).clear * np.cos(ANGLES)
    assert ((clear > 1.0) & (clear < 1.15 + 0.02)).all()
