"""The truth computed from a scene's construction is what an exact image of the scene shows."""

import math

import numpy as np
import pytest

from benchmarks.accuracy.cases import Case, camera_of, scene_of
from benchmarks.accuracy.frames import Sensor
from benchmarks.accuracy.scans import ANGLES
from benchmarks.accuracy.setups import BUILD, DROPS, GLOSSY, LEVEL, MOUNTED, SAFE
from cliffscan.common.contract.camera import scan_axes
from cliffscan.simulator.kinect import KinectModel, returns
from evaluation.truth.scene_truth import first_drop, truth_of
from evaluation.truth.sight import floor_points, pixels, row_spacing

FLAT = 1e-3  # [m]
SEEDS = range(6)


def traced(case):
    """For each beam, the heights and distances [m] of the pixels nearest to its middle, from the bottom row up."""
    camera = camera_of(case)
    depth = Sensor(scene_of(case), case.rng("test"), case.setup.model(camera_of(case))).exact(camera)
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    azimuth = np.arctan2(left, forward)
    column = np.stack([np.interp(-ANGLES, -row, np.arange(camera.width)) for row in azimuth])
    column = np.round(column).astype(int)
    row = np.arange(camera.height)[:, None]
    heights = up[row, column] * depth[row, column] + camera.floor.d
    return heights[::-1], (np.hypot(forward, left) * depth)[row, column][::-1]


def ends(case):
    """The distances [m] of the last pixel of floor before something else, and of the first pixel after it."""
    heights, distances = traced(case)
    floor = np.abs(heights) < FLAT
    started = np.maximum.accumulate(floor, axis=0)
    last = np.argmax(started & ~floor, axis=0) - 1
    return distances[last, np.arange(len(ANGLES))], heights[last + 1, np.arange(len(ANGLES))]


@pytest.mark.parametrize("mount", [LEVEL, MOUNTED])
@pytest.mark.parametrize("kind", sorted({build.__name__ for build in DROPS}))
def test_last_pixel_of_floor_lies_one_row_before_the_edge(kind, mount):
    off, beams = 0, 0
    for seed in SEEDS:
        case = Case(kind, seed, mount)
        truth = truth_of(scene_of(case), camera_of(case), ANGLES)
        seen, _ = ends(case)
        slack = 0.2 * truth.allowed + 0.003  # a pixel's column is not quite the beam's middle
        error = (seen - truth.edge)[truth.drop]
        low = -(1.2 * truth.allowed + slack)[truth.drop]
        off += int(((error < low) | (error > slack[truth.drop])).sum())
        beams += int(truth.drop.sum())
    assert beams > 0
    assert off <= 0.004 * beams  # posts and corners, where half a pixel aside is another thing


def returns_before_edge(case):
    """Of the three pixels of floor before each edge that must be found, how many return light."""
    camera, scene = camera_of(case), scene_of(case)
    truth = truth_of(scene, camera, ANGLES)
    kept = (
        returns(Sensor(scene, case.rng("test"), case.setup.model(camera_of(case))).exact(camera), camera, KinectModel())
        > 0
    )
    left, top, right, bottom = camera.region
    kept[:top], kept[bottom + 1 :], kept[:, :left], kept[:, right + 1 :] = False, False, False, False
    angles, edge = ANGLES[truth.drop], truth.edge[truth.drop]
    spacing = row_spacing(camera, angles, edge)
    count = np.zeros(len(angles), dtype=int)
    for rows in (0.55, 1.55, 2.55):
        column, row, _ = pixels(camera, floor_points(angles, edge - rows * spacing))
        count += kept[np.round(row).astype(int), np.clip(np.round(column), 0, camera.width - 1).astype(int)]
    return count


@pytest.mark.parametrize("mount", [LEVEL, MOUNTED, "rolled", "border"])
def test_the_sensor_sees_the_floor_before_every_edge_that_must_be_found(mount):
    cases = [Case(build.__name__, seed, mount) for build in DROPS for seed in SEEDS]
    counts = np.concatenate([returns_before_edge(case) for case in cases])
    assert len(counts) > 1000
    assert np.mean(counts < 2) <= 0.001  # at the border of a shadow or a post, where half a pixel counts


@pytest.mark.parametrize("kind", sorted(build.__name__ for build in SAFE))
def test_safe_scenes_have_no_drop_and_show_nothing_that_is_not_floor_or_obstacle(kind):
    for seed in SEEDS:
        case = Case(kind, seed)
        truth = truth_of(scene_of(case), camera_of(case), ANGLES)
        assert not truth.drop.any()
        assert np.isinf(truth.edge).all()
        heights, _ = traced(case)
        lowest = np.nanmin(np.where(np.isfinite(heights), heights, np.nan))
        assert lowest > (-math.inf if kind == "ramp_down" else -FLAT)


@pytest.mark.parametrize("kind", sorted(build.__name__ for build in SAFE if "ramp" not in build.__name__))
def test_nothing_is_undecidable_without_a_ramp(kind):
    case = Case(kind, 1)
    assert not truth_of(scene_of(case), camera_of(case), ANGLES).undecidable.any()


def grazing_losses(case):
    """Per beam the distance [m] of the last pixel that returns light, of a sensor that loses nothing but by angle."""
    camera = camera_of(case)
    depth = Sensor(scene_of(case), case.rng("test"), case.setup.model(camera_of(case))).exact(camera)
    kept = returns(depth, camera, KinectModel(baseline=0.0, grazing=scene_of(case).grazing)) > 0
    forward, left, _ = (axis.table() for axis in scan_axes(camera))
    middle = camera.width // 2
    reached = np.where(kept, np.hypot(forward, left) * depth, 0.0)[:, middle]
    return reached.max(), math.atan2(left[0, middle], forward[0, middle])


@pytest.mark.parametrize("kind", ["ramp_down", "ramp_up"])
def test_a_ramp_is_lost_where_the_sensor_gets_nothing_back(kind):
    undecidable = 0
    for seed in range(40):
        case = Case(kind, seed)
        reached, azimuth = grazing_losses(case)
        truth = truth_of(scene_of(case), camera_of(case), ANGLES)
        beam = int(np.argmin(np.abs(ANGLES - azimuth)))
        undecidable += bool(truth.undecidable[beam])
        if not truth.undecidable[beam]:
            assert reached > 4.4
    assert undecidable > 0


@pytest.mark.parametrize("kind", sorted(BUILD))
def test_the_same_case_is_the_same_scene(kind):
    one, other = scene_of(Case(kind, 3)), scene_of(Case(kind, 3))
    assert len(one.faces) == len(other.faces)
    assert all(np.array_equal(a, b) for a, b in zip(one.faces, other.faces, strict=True))


def test_glossy_floor_is_no_drop():
    case = Case(GLOSSY, 1)
    assert np.isinf(truth_of(scene_of(case), camera_of(case), ANGLES).edge).all()


@pytest.mark.parametrize(("group", "least", "most"), [("corners", 0.10, 0.20), ("tips", 0.05, 0.10)])
def test_at_a_corner_only_beams_with_little_of_the_hole_must_find_it(group, least, most):
    beams = 0
    for seed in SEEDS:
        case = Case("hole", seed, group)
        truth = truth_of(scene_of(case), camera_of(case), ANGLES, case.setup.lengths)
        edge, end = first_drop(scene_of(case), ANGLES)
        length = end[truth.drop] - edge[truth.drop]
        assert (length >= least).all()
        assert (length <= most).all() or scene_of(case).obstacles  # what stands in the hole shortens it
        beams += int(truth.drop.sum())
    assert beams > 0


def test_a_rough_ramp_far_ahead_is_seen_to_the_end_unless_its_crest_hides_it():
    seen = 0
    for seed in SEEDS:
        case = Case("ramp_ahead", seed, "ramps")
        reached, azimuth = grazing_losses(case)
        truth = truth_of(scene_of(case), camera_of(case), ANGLES)
        beam = int(np.argmin(np.abs(ANGLES - azimuth)))
        seen += not truth.undecidable[beam]
        assert truth.undecidable[beam] or reached > 3.4
    assert seen > 0
