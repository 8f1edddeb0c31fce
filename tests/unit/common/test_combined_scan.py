"""The combined negative scan is the combination of the scans that are published beside it."""

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import combine
from cliffscan.services.negative.__main__ import serve
from cliffscan.services.negative.config import NegativeConfig
from tests import build, scenes

CAMERA = scenes.camera(floor=FloorPlane.from_mount(0.3, math.radians(12)))
METHODS = ("farthest_point", "virtual_floor", "near_edge")
PAPER = METHODS[:2]


def published(config, lost, monkeypatch):
    """The scans of a hole of which a share of the pixels is lost: of each method, and combined."""
    depth = scenes.depth(CAMERA, [scenes.HOLE])
    depth[np.random.default_rng(0).random(depth.shape) < lost] = 0
    image = DepthImage.pack(1, 2, "camera", depth, CAMERA, RAW)
    said = build.play(serve, "negative", config, [("camera/depth", image.encode())], monkeypatch).bus.said
    (combined,) = said["scan/negative"]
    return [said[f"scan/negative/{method}"][0] for method in config.methods], combined


@pytest.mark.parametrize("range_max", [10.0, 1.7])
@pytest.mark.parametrize("lost", [0.0, 0.9, 1.0])
@pytest.mark.parametrize("methods", [PAPER, METHODS], ids=["paper", "all"])
def test_it_is_the_combination_of_the_others(range_max, lost, methods, monkeypatch):
    scans, combined = published(NegativeConfig(range_max=range_max, methods=methods), lost, monkeypatch)
    expected = combine(scans)
    assert_array_equal(combined.ranges, expected.ranges)
    assert_array_equal(combined.intensities, expected.intensities)
    assert_array_equal(combined.clear, expected.clear)
    assert bool(len(combined.clear)) == ("near_edge" in methods)


def test_nothing_beyond_range_max_is_said(monkeypatch):
    scans, combined = published(NegativeConfig(range_max=1.7, methods=METHODS), 0.0, monkeypatch)
    for scan in (*scans, combined):
        assert scan.range_max == 1.7
        assert (scan.ranges[np.isfinite(scan.ranges)] <= np.float32(1.7)).all()
        assert np.isposinf(scan.ranges).any()


def test_every_scan_is_of_the_frame(monkeypatch):
    scans, combined = published(NegativeConfig(methods=METHODS), 0.0, monkeypatch)
    assert {(scan.seq, scan.stamp, len(scan.ranges)) for scan in [*scans, combined]} == {(1, 2, 640)}
    assert [set(np.unique(scan.intensities)) - {0} for scan in scans] == [{4}, {2}, {2}]


@pytest.mark.parametrize("method", METHODS)
def test_one_method_alone_is_the_combined_scan(method, monkeypatch):
    (scan,), combined = published(NegativeConfig(methods=(method,)), 0.3, monkeypatch)
    assert_array_equal(combined.ranges, scan.ranges)
