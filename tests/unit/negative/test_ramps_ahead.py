"""A ramp down whose crest lies far ahead is no drop; a kerb there is one, whatever else it looks like."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.services.negative.beam_lines import beam_lines, heights_along, rows_outward
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.floor_following import End, floor_trace, single
from cliffscan.services.negative.methods import near_edge as of_near_edge
from cliffscan.services.negative.ramps import ramps_ahead, resolves_ramps
from cliffscan.services.negative.scans import beams_by_method, negative_scans
from cliffscan.simulator.kinect import kinect_camera
from cliffscan.simulator.sensors import sensor_camera
from tests import naive_trace, scenes
from tests.unit.negative.test_near_edge_floors import SEEDS, ramp, seen_by_kinect

CONFIG = NegativeConfig()
AHEAD = [(2.0, 3.0), (2.0, 4.0), (2.0, 5.0), (2.8, 3.0), (2.8, 4.0), (2.8, 5.0), (3.0, 3.0), (3.0, 4.0), (3.2, 3.0),
         (3.2, 4.0)]  # fmt: skip


def found(image):
    return beams_by_method(image, CONFIG, ["near_edge"])["near_edge"]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("crest", "degrees"), AHEAD)
def test_a_ramp_that_is_seen_far_ahead_is_no_drop(crest, degrees, seed):
    camera = kinect_camera()
    beams = found(seen_by_kinect(ramp(camera, crest, -degrees, end=9.0), camera, seed, grazing=0.0))
    assert np.isfinite(beams.ranges).mean() < 0.005
    assert (beams.clear * np.cos(CONFIG.grid().angles()) > crest - 0.1).mean() > 0.99


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("fall", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("edge", [2.0, 2.8])
def test_a_kerb_as_far_ahead_is_a_drop(edge, fall, seed):
    camera = kinect_camera()
    depth = scenes.depth(camera, [(edge, -9.0, -fall, 60.0, 9.0, 0.0)], wall=60.0)
    beams = found(seen_by_kinect(depth, camera, seed, grazing=0.0))
    assert np.isfinite(beams.ranges).mean() > 0.99


def test_a_blank_frame_compiles_what_resolves_ramps(monkeypatch):
    called = []
    monkeypatch.setattr(of_near_edge, "ramps_ahead", lambda *given: (called.append(given), ramps_ahead(*given))[1])
    negative_scans(WARMUP_IMAGE, CONFIG)
    assert len(called) == 1


@pytest.mark.parametrize("name", ["d435", "d415"])
def test_what_smears_edges_tells_no_ramps(name):
    assert not resolves_ramps(sensor_camera(name))


@pytest.mark.parametrize("name", ["kinect", "kinect_v2", "azure_kinect"])
def test_what_sees_edges_sharply_resolves_ramps(name):
    assert resolves_ramps(sensor_camera(name))


@pytest.mark.parametrize("noise", [0.5, 1.0, 3.0])
@pytest.mark.parametrize(("pitch", "roll"), [(0.0, 0.0), (5.0, 0.0), (0.0, 4.0), (0.0, 180.0)])
def test_as_its_slow_twin(pitch, roll, noise):
    mounted = replace(kinect_camera(), floor=FloorPlane.from_mount(0.3, math.radians(pitch), math.radians(roll)))
    camera = replace(mounted, noise=noise * mounted.noise)
    met = set()
    for number, (crest, degrees) in enumerate([(2.0, 4.0), (2.8, 5.0), (3.0, 4.0), (3.0, 5.0), (3.2, 3.0), (2.5, 9.0)]):
        image = seen_by_kinect(ramp(camera, crest, -degrees, end=9.0), camera, number, grazing=0.0, dropout=0.1)
        met |= assert_alike(image, camera)
    assert met == {False, True}


def assert_alike(image, camera):
    """Both find the same lines' ramps, of some lines and what rows they took for the last floor; what they found."""
    seen = floor_points(image.depth, camera, lower_than=CONFIG.floor_band)
    criteria, height = CONFIG.criteria(camera), camera.floor.d
    lines = beam_lines(seen.region, CONFIG.grid(), 1)
    order = rows_outward(seen.region, lines, criteria.far)
    heights, in_view = heights_along(seen, lines, order)
    end, row, *_ = floor_trace(heights, order, lines, in_view, np.float32(height), single(criteria))
    some = np.flatnonzero((end == End.DROP) | (end == End.NO_RETURN))[::9]
    limits = camera.range[1], criteria.noise, criteria.slope, criteria.grazing
    ramps = ramps_ahead(heights, order, lines, some, row[some], height, *limits)
    view = naive_trace.View(lines, in_view)
    for line, fast in zip(some, ramps, strict=True):
        slow = naive_trace.ramp_ahead(heights, order, view, camera, criteria, int(line), int(row[line]))
        assert fast == slow, f"line {line}"
    return set(ramps.tolist())
