"""Floor without data counts as a drop, or only beside one that is seen, or not at all."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import beams_by_method
from tests import scenes

CAMERA = scenes.camera(320, 240, FloorPlane.from_mount(0.3, math.radians(12)))
DROP, LOST = int(Evidence.DROP), int(Evidence.FLOOR_LOST)
FAR = (1.5, 2.4)  # [m] of the hole


def frame(seen_from=1.0, seen_to=1.0):
    """A hole 1.2 m wide, whose bottom is seen in that share of its width only; no data in the rest."""
    depth = scenes.depth(CAMERA, [scenes.HOLE], wall=60.0)
    floor = scenes.depth(CAMERA, wall=60.0)
    hole = np.argwhere(depth != floor)
    columns = np.arange(CAMERA.width)
    share = (columns - hole[:, 1].min()) / np.ptp(hole[:, 1])
    dark = (depth != floor) & ~((share >= seen_from) & (share <= seen_to))
    return np.where(dark, 0, depth).astype(np.uint16)


def told(depth, floor_lost):
    image = DepthImage.pack(0, 0, "camera", depth, CAMERA, RAW)
    return beams_by_method(image, NegativeConfig(floor_lost=floor_lost), ["near_edge"])["near_edge"]


def crossing(beams):
    """Those beams that lead across the hole's middle."""
    across = np.abs(np.tan(NegativeConfig().grid().angles()) * FAR[0]) < 0.5
    return beams.ranges[across], beams.intensities[across]


@pytest.mark.parametrize("floor_lost", ["counts", "beside_drop", "ignored"])
def test_a_drop_that_is_seen_always_counts(floor_lost):
    ranges, evidence = crossing(told(frame(0.0, 1.0), floor_lost))
    assert np.isfinite(ranges).all()
    assert set(evidence) == {DROP}


def test_lost_floor_counts_at_first():
    ranges, evidence = crossing(told(frame(), "counts"))
    assert (np.abs(ranges - FAR[0]) < 0.15).all()
    assert set(evidence) == {LOST}


@pytest.mark.parametrize("floor_lost", ["beside_drop", "ignored"])
def test_alone_it_may_count_for_nothing_but_is_never_free(floor_lost):
    ranges, evidence = crossing(told(frame(), floor_lost))
    assert np.isnan(ranges).all()
    assert not evidence.any()


def test_beside_a_drop_it_counts():
    ranges, evidence = crossing(told(frame(0.3, 0.7), "beside_drop"))
    assert np.isfinite(ranges).all()
    assert set(evidence) == {DROP, LOST}


def test_ignored_it_does_not_count_even_there_and_what_is_seen_does():
    ranges, evidence = crossing(told(frame(0.3, 0.7), "ignored"))
    assert set(evidence[np.isfinite(ranges)]) == {DROP}
    assert 0.3 < np.isfinite(ranges).mean() < 0.7
    assert np.isnan(ranges[evidence == 0]).all()


def test_all_agree_where_nothing_is_lost():
    depth = frame(0.0, 1.0)
    for floor_lost in ("beside_drop", "ignored"):
        np.testing.assert_array_equal(told(depth, floor_lost).ranges, told(depth, "counts").ranges)
