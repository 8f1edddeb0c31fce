"""What stands on the floor is where it stands; and whatever comes in, positive answers the next good frame."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.depth_codec import LEVELS, RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.positive.__main__ import serve
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.projection import projection
from cliffscan.services.positive.scan import positive_scan
from tests import build, naive, scenes

CONFIG = PositiveConfig(beams=31)
LOOKING_DOWN = FloorPlane.from_mount(0.3, math.radians(15))


def image(stamp=7, camera=None, encoding=LEVELS, **scene):
    camera = camera or scenes.camera()
    return DepthImage.pack(stamp, stamp, "camera", scenes.depth(camera, **scene), camera, encoding)


def ranges_of(config=CONFIG, **scene):
    return positive_scan(image(**scene), config).ranges


def test_a_wall_is_as_far_as_it_is():
    angles = CONFIG.grid().angles()
    assert_allclose(ranges_of(wall=2.0), 2.0 / np.cos(angles), rtol=0.01)


def test_an_open_floor_is_free():
    assert np.isposinf(ranges_of(camera=scenes.camera(floor=LOOKING_DOWN), wall=60.0)).all()


@pytest.mark.parametrize(
    ("bottom", "top", "robot_height", "in_the_way"),
    [
        (0.0, 0.2, 0.42, True),
        (0.0, 0.02, 0.42, False),  # within the floor band
        (0.5, 0.8, 0.42, False),  # passed under
        (0.5, 0.8, 0.60, True),
        (0.35, 0.8, 0.42, True),
    ],
)
def test_what_is_between_the_floor_and_the_robots_height_is_in_the_way(bottom, top, robot_height, in_the_way):
    box = (1.2, -0.2, bottom, 1.4, 0.2, top)
    config = PositiveConfig(beams=31, robot_height=robot_height)
    middle = ranges_of(config, boxes=[box], wall=60.0)[15]
    assert np.isfinite(middle) == in_the_way
    if in_the_way:
        assert middle == pytest.approx(1.2, rel=0.01)


@pytest.mark.parametrize(
    ("height", "found"),
    [(-9.0, math.inf), (0.03, math.inf), (0.031, 2.0), (0.42, 2.0), (0.421, math.nan), (math.nan, math.nan)],
)
def test_the_floor_band_and_the_robots_height_belong_to_themselves(height, found):
    everywhere = np.full((48, 64), height, np.float32), np.full((48, 64), 2.0, np.float32)
    seen = floor_points(np.zeros((48, 64), np.uint16), scenes.camera())
    vars(seen)["_points"] = everywhere
    np.testing.assert_array_equal(projection(seen, CONFIG.grid(), 0.03, 0.42, 0.0, 0.0), np.full(31, found, np.float32))


def test_what_is_nearer_than_range_min_is_part_of_the_robot():
    box = (0.6, -0.2, 0.0, 0.7, 0.2, 0.25)
    assert ranges_of(boxes=[box], wall=2.0)[15] == pytest.approx(0.6, rel=0.01)
    behind = ranges_of(PositiveConfig(beams=31, range_min=0.8), boxes=[box], wall=2.0)[15]
    assert behind == pytest.approx(2.0, rel=0.01)  # above the box


def test_a_frame_without_returns_tells_nothing():
    blind = DepthImage.pack(1, 1, "camera", np.zeros((48, 64), np.uint16), scenes.camera(), RAW)
    assert np.isnan(positive_scan(blind, CONFIG).ranges).all()


@settings(max_examples=40)
@given(st.floats(0.1, 1.5), st.floats(-0.3, 0.7), st.floats(-0.5, 0.5), st.integers(0, 2**32 - 1))
def test_no_point_in_the_way_is_farther_than_its_beam_says(height, pitch, roll, seed):
    camera = scenes.camera(12, 10, FloorPlane.from_mount(height, pitch, roll))
    depth = np.random.default_rng(seed).integers(0, 7000, (10, 12)).astype(np.uint16)
    # no beam begins, ends or has its middle where a column does
    flat, default = (PositiveConfig(beams=30, field_of_view=57, flat_floor=flat) for flat in (True, False))
    picture = DepthImage.pack(1, 1, "camera", depth, camera, RAW)
    found, with_ramps = positive_scan(picture, flat).ranges, positive_scan(picture, default).ranges
    for beam, x, y, above in naive.points(depth, camera, flat.grid()):
        distance = math.hypot(x, y)
        if flat.floor_band + 1e-9 < above <= flat.robot_height - 1e-9:
            assert found[beam] <= distance * (1 + 1e-6)
        if flat.floor_band + default.slope * distance + 1e-6 < above <= flat.robot_height - 1e-9:
            assert with_ramps[beam] <= distance * (1 + 1e-6)  # higher than any ramp up to there


def play(config, images, monkeypatch):
    arriving = [("camera/depth", each if isinstance(each, bytes) else each.encode()) for each in images]
    service = build.play(serve, "positive", config, arriving, monkeypatch)
    return service.bus.said["scan/positive"], service.metrics.counts()


def test_every_answer_is_counted_as_an_output(monkeypatch):
    arriving = [("camera/depth", image(stamp).encode()) for stamp in (1, 2, 3)]
    assert build.play(serve, "positive", CONFIG, arriving, monkeypatch).metrics.take_outputs() == 3


def test_every_frame_is_answered_with_a_scan_of_its_stamp(monkeypatch):
    said, counts = play(CONFIG, [image(1), image(2, encoding=RAW), image(3, wall=1.0)], monkeypatch)
    assert [(scan.seq, scan.stamp) for scan in said] == [(1, 1), (2, 2), (3, 3)]
    np.testing.assert_array_equal(said[0].ranges, said[1].ranges)
    assert said[2].ranges[15] == pytest.approx(1.0, rel=0.01)
    assert set(said[2].intensities[np.isfinite(said[2].ranges)]) == {1}
    assert counts == {"received": 3, "published": 3}


def test_nothing_beyond_range_max_is_said(monkeypatch):
    ((scan,), _) = play(PositiveConfig(beams=31, range_max=2.1), [image(1, wall=2.0)], monkeypatch)
    assert scan.range_max == 2.1
    assert scan.ranges[15] == pytest.approx(2.0, rel=0.01)
    assert np.isposinf(scan.ranges[[0, -1]]).all()  # the wall's ends are 2.29 m away
    assert not scan.intensities[[0, -1]].any()


def test_a_bad_frame_costs_itself_only(monkeypatch):
    small = image(2, camera=scenes.camera(32, 24))
    said, counts = play(CONFIG, [image(1), b"\x00", small, image(1), image(3)], monkeypatch)
    assert [scan.stamp for scan in said] == [1, 2, 1, 3]
    assert counts == {"received": 4, "published": 4, "malformed": 1, "stamp_back": 1}


def test_a_frame_of_a_sensor_that_reaches_less_far_than_range_min_costs_itself_only(monkeypatch):
    short = image(1, camera=scenes.camera(reach=(0.01, 0.1)), wall=0.05)
    try:
        said, _ = play(PositiveConfig(beams=31, range_min=0.2), [short, image(2)], monkeypatch)
    except ValueError as error:
        pytest.fail(f"ended by a frame: {str(error).splitlines()[1]}")
    assert said[-1].stamp == 2


@pytest.mark.parametrize("look", [0, 12])
def test_frames_in_which_nothing_can_be_seen_are_answered(monkeypatch, look):
    camera = scenes.camera(floor=FloorPlane.from_mount(20.0, math.radians(look)), reach=(0.0, 0.001))
    said, _ = play(CONFIG, [image(1, camera=camera)], monkeypatch)
    assert not np.isfinite(said[0].ranges).any()
