"""What is a floor, and what is a drop: ramps, kerbs, the shadow beside a box, the end of the sensor's range."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import KINECT_NOISE, Camera, FloorPlane, Region, scan_axes
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.scans import beams_by_method
from cliffscan.simulator.kinect import KinectModel, kinect_camera, measure, returns
from tests import scenes

SEEDS = range(3)
BOX = (1.0, -0.1, 0.0, 1.3, 0.3, 0.25)


def seen_by_kinect(millimetres: np.ndarray, camera: Camera, seed: int, **changes) -> DepthImage:
    """The frame that a noisy Kinect makes of an exact image."""
    metres = np.where(millimetres > 0, millimetres / 1000, np.inf).astype(np.float32)
    model = KinectModel(**changes)
    depth = measure(returns(metres, camera, model), camera, model, np.random.default_rng(seed))
    return DepthImage.pack(0, 0, "camera", depth, camera, RAW)


def drops(image: DepthImage, **config) -> np.ndarray:
    """The ranges, of the beams that tell a drop."""
    ranges = beams_by_method(image, NegativeConfig(**config), ["near_edge"])["near_edge"].ranges
    return ranges[np.isfinite(ranges)]


def ramp(camera: Camera, start: float, degrees: float, end: float = 2.6) -> np.ndarray:
    """(rows, columns) [mm]: a floor that from x = start to x = end rises, or falls, and then is level again."""
    forward, _, up = (axis.table() for axis in scan_axes(camera))
    slope, height = math.tan(math.radians(degrees)), camera.floor.d
    with np.errstate(divide="ignore", invalid="ignore"):
        flat, top = -height / up, (slope * (end - start) - height) / up
        sloping = (-slope * start - height) / (up - slope * forward)
        on_ramp = (sloping > 0) & (forward * sloping >= start) & (forward * sloping < end)
        nearest = np.where((up < 0) & (forward * top >= end), top, 60.0)
        nearest = np.where(on_ramp & (sloping < nearest), sloping, nearest)
        nearest = np.where((up < 0) & (forward * flat < start), flat, nearest)
    return np.round(nearest * 1000).astype(np.uint16)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("start", [0.9, 1.5])
@pytest.mark.parametrize("degrees", [5.0, 2.5, -2.5, -5.0])
@pytest.mark.parametrize(("height", "pitch"), [(0.3, 0.0), (0.5, 20.0)])
def test_a_ramp_that_can_be_driven_is_floor(height, pitch, degrees, start, seed):
    camera = kinect_camera(height, math.radians(pitch))
    assert not len(drops(seen_by_kinect(ramp(camera, start, degrees, end=2.2), camera, seed)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("distance", [0.9, 1.2, 1.5])
def test_a_kerb_of_5_cm_is_a_drop(distance, seed):
    camera = kinect_camera()
    depth = scenes.depth(camera, [(distance, -9.0, -0.05, 9.0, 9.0, 0.0)], wall=60.0)
    ranges = drops(seen_by_kinect(depth, camera, seed))
    angles = NegativeConfig().grid().angles()
    assert len(ranges) > 0.99 * len(angles)
    assert np.median(ranges) == pytest.approx(np.median(distance / np.cos(angles)), abs=0.03)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("box", [BOX, (1.8, -0.3, 0.0, 2.0, 0.0, 0.6), (0.8, -0.02, 0.0, 0.84, 0.02, 0.8)])
def test_the_shadow_beside_a_box_is_no_drop(box, seed):
    camera = kinect_camera()
    image = seen_by_kinect(scenes.depth(camera, boxes=[box]), camera, seed)
    assert not len(drops(image))


def test_a_sensor_without_a_baseline_has_no_shadows():
    camera = replace(kinect_camera(), baseline=0.0)
    image = seen_by_kinect(scenes.depth(camera, boxes=[BOX]), camera, seed=1, dropout=0.0)
    assert len(drops(image)) > 5  # so the last test has something to show


@pytest.mark.parametrize("far", [1.5, 2.5, 4.5, 8.0])
@pytest.mark.parametrize("height", [0.2, 0.3, 0.8])
def test_where_the_sensors_range_ends_there_is_no_drop(height, far):
    camera = replace(kinect_camera(height, math.radians(10)), range=(0.5, far))
    for seed in SEEDS:
        image = seen_by_kinect(scenes.depth(camera, wall=60.0), camera, seed)
        ranges = beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"].ranges
        assert np.isposinf(ranges).mean() > 0.99
        assert not np.isfinite(ranges).any()


def test_a_wall_that_hides_the_floor_is_no_drop_and_nothing_is_known_behind_it():
    camera = kinect_camera()
    image = seen_by_kinect(scenes.depth(camera, wall=2.0), camera, seed=0)
    assert np.isnan(beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"].ranges).all()


def test_a_table_in_the_way_of_nothing_hides_no_drop_behind_its_legs():
    camera = kinect_camera()
    depth = scenes.depth(camera, [scenes.HOLE], [(1.0, -0.3, 0.0, 1.05, -0.25, 0.5)], wall=60.0)
    for seed in SEEDS:
        ranges = drops(seen_by_kinect(depth, camera, seed))
        assert len(ranges) > 300
        assert (np.abs(ranges - 1.55) < 0.15).all()


def test_the_steepest_floor_can_be_configured():
    camera = kinect_camera(0.5, math.radians(20))
    image = seen_by_kinect(ramp(camera, 1.2, -9.0), camera, seed=0)
    assert len(drops(image)) > 300
    assert not len(drops(image, steepest=10.0))


def test_a_floor_may_be_seen_from_any_height_upside_down():
    camera = replace(kinect_camera(), floor=FloorPlane.from_mount(0.4, math.radians(10), math.pi))
    depth = scenes.depth(camera, [scenes.HOLE], wall=60.0)
    ranges = drops(seen_by_kinect(depth, camera, seed=0))
    assert len(ranges) > 300
    assert (np.abs(ranges - 1.55) < 0.15).all()


@pytest.mark.parametrize("roll", [5.0, -10.0, 20.0, 45.0, 70.0, 90.0, -90.0, 170.0])
@pytest.mark.parametrize(("height", "pitch"), [(0.3, 0.0), (1.0, 25.0)])
def test_a_rolled_camera_sees_a_flat_floor_throughout(height, pitch, roll):
    camera = replace(kinect_camera(), floor=FloorPlane.from_mount(height, math.radians(pitch), math.radians(roll)))
    image = seen_by_kinect(scenes.depth(camera, wall=60.0), camera, seed=1)
    beams = beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"]
    forward, left, up = (axis.table() for axis in scan_axes(camera))
    floor = (forward > 0) & (-up > camera.floor.d / 3.5) & (-up < camera.floor.d / 0.6)
    least, most = (getattr(np.arctan2(left, forward)[floor], end)() for end in ("min", "max"))
    angles = NegativeConfig().grid().angles()
    inside = (angles > least + 0.03) & (angles < most - 0.03)
    assert inside.sum() > 400
    assert not np.isfinite(beams.ranges).any()
    assert np.isposinf(beams.ranges[inside]).mean() >= 0.995


@pytest.mark.parametrize("roll", [8.0, -8.0])
def test_a_hole_right_before_a_rolled_camera_is_not_free(roll):
    camera = replace(kinect_camera(), floor=FloorPlane.from_mount(0.3, 0.0, math.radians(roll)))
    depth = scenes.depth(camera, wall=60.0)
    forward, _, up = (axis.table() for axis in scan_axes(camera))
    with np.errstate(divide="ignore"):
        depth[(up < 0) & (forward * -camera.floor.d / up < 0.74)] = 0  # no return of it
    image = seen_by_kinect(depth, camera, seed=1)
    beams = beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"]
    aside = -np.sign(roll) * NegativeConfig().grid().angles()  # a camera that leans right is lowered on the right
    lowered = (aside > 0.2) & (aside < 0.35)  # farther aside a beam enters the image beyond the hole
    assert (beams.clear[lowered] == 0.0).all()


@pytest.mark.parametrize("range_min", [0.75, 0.9, 1.5])
def test_range_min_may_lie_beyond_the_nearest_floor_in_view(range_min):
    camera = kinect_camera()
    image = seen_by_kinect(scenes.depth(camera, wall=60.0), camera, seed=1)
    beams = beams_by_method(image, NegativeConfig(range_min=range_min), ["near_edge"])["near_edge"]
    assert np.isposinf(beams.ranges).mean() >= 0.995


def test_an_empty_border_is_no_hole_where_the_region_says_so():
    camera = kinect_camera(1.4, math.radians(16))
    depth = scenes.depth(camera, wall=60.0)
    depth[460:] = 0
    blind = seen_by_kinect(depth, camera, seed=1)
    seen = seen_by_kinect(depth, replace(camera, seen=Region(0, 0, 639, 459)), seed=1)
    clear = [beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"].clear for image in (blind, seen)]
    assert (clear[0] == 0.0).all()
    assert (clear[1] > 2.0).all()


@pytest.mark.parametrize("noise", [KINECT_NOISE, KINECT_NOISE / 2])
@pytest.mark.parametrize(("fall", "smear"), [(0.08, 0.4), (0.11, 0.4), (0.11, 0.7)])
def test_a_kerb_whose_face_is_smeared_into_a_slope_is_a_drop(fall, smear, noise):
    camera = replace(kinect_camera(0.52, math.radians(6)), noise=noise)
    forward, _, up = (axis.table() for axis in scan_axes(camera))
    start, slope = 2.0, -fall / smear
    with np.errstate(divide="ignore"):
        flat, face, road = -0.52 / up, (slope * -start - 0.52) / (up - slope * forward), (-fall - 0.52) / up
    on_face = (face * forward >= start) & (face * forward < start + smear)
    depth = np.where(flat * forward < start, flat, np.where(on_face, face, road))
    depth = np.where((up < 0) & (depth > 0) & (depth < 20.0), depth * 1000, 0).astype(np.uint16)
    image = seen_by_kinect(depth, camera, seed=3, noise=0.8 * noise, step=0.0)
    beams = beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"]
    assert not np.isposinf(beams.ranges).any()
    assert (beams.clear < start + smear + 0.3).all()
    assert np.isfinite(beams.ranges).mean() > 0.9


def test_a_part_of_the_robot_in_view_costs_nothing_but_a_hole_there_is_told():
    camera, config = kinect_camera(), NegativeConfig(range_min=0.95)
    arm = scenes.depth(camera, boxes=[(0.75, -0.1, 0.0, 0.8, 0.1, 0.05)], wall=60.0)
    hole = scenes.depth(camera, [(0.75, -5.0, -0.4, 1.6, 5.0, 0.0)], wall=60.0)
    clear = beams_by_method(seen_by_kinect(arm, camera, seed=1), config, ["near_edge"])["near_edge"].clear
    told = beams_by_method(seen_by_kinect(hole, camera, seed=1), config, ["near_edge"])["near_edge"]
    assert (clear > 2.0).mean() > 0.9
    assert (told.ranges == np.float32(0.95)).mean() > 0.95
    assert (told.clear < 0.95).all()


@pytest.mark.parametrize("start", [0.78, 0.9])
def test_near_the_robot_a_hole_is_found_that_is_10_cm_long(start):  # a corner's last beams cross no more
    camera = kinect_camera()
    depth = scenes.depth(camera, [(start, -5.0, -0.4, start + 0.1, 5.0, 0.0)], wall=60.0)
    beams = beams_by_method(seen_by_kinect(depth, camera, seed=1), NegativeConfig(), ["near_edge"])["near_edge"]
    assert np.isfinite(beams.ranges).mean() > 0.95
    assert (beams.clear * np.cos(NegativeConfig().grid().angles()) < start + 0.1).mean() > 0.95


@pytest.mark.parametrize("roll", [0.0, 30.0, 45.0, 90.0])
@pytest.mark.parametrize("pitch", [40.0, 60.0])
def test_a_steep_camera_sees_the_floor_up_to_the_images_border(pitch, roll):
    camera = kinect_camera(1.0, math.radians(pitch), math.radians(roll))
    image = seen_by_kinect(scenes.depth(camera, wall=60.0), camera, seed=1)
    beams = beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"]
    assert np.isposinf(beams.ranges).mean() > 0.995  # all beams have floor in view
    assert (beams.clear > 0.8).mean() > 0.99
