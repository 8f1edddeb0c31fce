"""The floor is followed in each column as the slow twin follows it, in every scene, any camera and any noise."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.accuracy.cases import Case
from benchmarks.accuracy.frames import KNOWN, frames_of
from benchmarks.accuracy.setups import BUILD
from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.services.negative.beam_lines import beam_lines, heights_along, rows_outward
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.floor_following import End, floor_trace, single
from tests import naive_trace, scenes

CONFIG = NegativeConfig()
MOUNTS = {
    "level": (0.3, 0.0, 0.0),
    "pitched": (0.45, 20.0, 0.0),
    "rolled": (0.3, 5.0, 3.0),
    "upside down": (0.3, 10.0, 180.0),
    "on its side": (0.4, 15.0, 90.0),
}


def mounted(width, height, mount):
    return scenes.camera(width, height, FloorPlane.from_mount(mount[0], *np.radians(mount[1:])))


def assert_traced_alike(depth, camera, every=5):
    """Both traces of every so many columns are the same to the last bit; how they ended."""
    seen = floor_points(depth, camera, lower_than=CONFIG.floor_band)
    criteria, height = CONFIG.criteria(camera), np.float32(camera.floor.d)
    lines = beam_lines(seen.region, CONFIG.grid(), 1)
    order = rows_outward(seen.region, lines, criteria.far)
    if not len(order):
        return set()
    heights, in_view = heights_along(seen, lines, order)
    ends, *traced = floor_trace(heights, order, lines, in_view, height, single(criteria))
    view = naive_trace.View(lines, in_view)
    for line in range(0, len(ends), every):
        slow = naive_trace.floor_trace(heights, order, view, height, criteria, line)
        fast = End(int(ends[line])), *(each[line] for each in traced)
        assert fast == slow, f"line {line}"
    return {End(int(end)) for end in ends}


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("scene", scenes.SCENES)
def test_scenes(scene, mount):
    camera = mounted(64, 48, MOUNTS[mount])
    assert_traced_alike(scenes.depth(camera, **scenes.SCENES[scene]), camera)


@pytest.mark.parametrize("mount", ["level", "mounted"])
@pytest.mark.parametrize("kind", sorted(BUILD))
def test_frames_of_a_noisy_kinect(kind, mount):
    (frame,) = frames_of(Case(kind, 1, mount), KNOWN)
    assert_traced_alike(frame.depth, frame.camera, every=53)


def test_every_end_is_met():
    cases = [Case("hole", 2), Case("boxes", 1), Case("stairwell", 3), Case("lost_returns", 2)]
    frames = [next(frames_of(case, KNOWN)) for case in cases]
    met = set().union(*(assert_traced_alike(frame.depth, frame.camera, every=80) for frame in frames))
    assert met == set(End) - {End.GOING}


@pytest.mark.parametrize("fall", [0.015, 0.02, 0.024, 0.05])
def test_a_step_down(fall):
    camera = mounted(320, 240, MOUNTS["pitched"])
    depth = scenes.depth(camera, [(2.0, -5.0, -fall, 9.0, 5.0, 0.0)], wall=9.0)
    assert (End.DROP in assert_traced_alike(depth, camera, every=19)) == (fall == 0.05)


def test_floor_that_is_lost_before_a_box():
    camera, met = mounted(64, 480, MOUNTS["level"]), set()
    camera = replace(camera, intrinsics=camera.intrinsics._replace(fy=575.0))
    depth = scenes.depth(camera, boxes=[(2.0, -5.0, 0.0, 2.2, 5.0, 0.3)])
    foot = round(camera.intrinsics.cy + 575 * 0.3 / 2.0)
    for rows in range(1, 9):
        lost = depth.copy()
        lost[foot : foot + rows] = 0
        met |= assert_traced_alike(lost, camera, every=19)
    assert met == {End.OCCLUDED, End.NO_RETURN}


@settings(max_examples=40)
@given(
    st.floats(0.1, 1.5),
    st.floats(-10, 50),
    st.sampled_from([0.0, 3.0, -20.0, 90.0, 180.0]),
    st.floats(0, 0.5),
    st.floats(0, 0.1),
    st.integers(0, 2**32 - 1),
)
def test_any_camera_and_any_noise(height, pitch, roll, lost, spread, seed):
    camera = mounted(32, 24, (height, pitch, roll))
    depth = scenes.depth(camera, [scenes.HOLE], [(0.8, 0.0, 0.0, 1.0, 0.3, 0.6)])
    noise = np.random.default_rng(seed)
    depth = depth * (1.0 + spread * noise.standard_normal(depth.shape))
    depth[noise.random(depth.shape) < lost] = 0
    assert_traced_alike(np.clip(depth, 0, 65535).astype(np.uint16), camera)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_nothing_but_noise(seed):
    camera = mounted(24, 18, (0.3, math.degrees(0.2), 1.0))
    depth = np.random.default_rng(seed).integers(0, 5000, (18, 24)).astype(np.uint16)
    assert_traced_alike(depth, camera)
