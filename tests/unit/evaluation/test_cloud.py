"""Pixels are told apart by the height of what they saw."""

import numpy as np

from evaluation.pictures.cloud import Bands, Cloud, Kind, cloud, kinds
from tests import scenes
from tests.unit.experiments.made_up import image


def test_kinds_by_height():
    heights = np.array([np.nan, -0.031, -0.029, 0.029, 0.031, 0.42, 0.43])
    found = kinds(Cloud(heights, heights, heights), Bands(0.03, 0.42))
    assert found.tolist() == [
        Kind.NOTHING,
        Kind.BELOW,
        Kind.FLOOR,
        Kind.FLOOR,
        Kind.OBSTACLE,
        Kind.OBSTACLE,
        Kind.OVERHEAD,
    ]


def test_a_scenes_points_lie_where_it_was_built():
    points = cloud(image())
    found = kinds(points, Bands())
    box, below, overhead = (found == kind for kind in (Kind.OBSTACLE, Kind.BELOW, Kind.OVERHEAD))
    near_box = box & (points.ahead < 4.9)
    assert ((points.left[near_box] > 0.49) & (points.left[near_box] < 0.81)).all()
    assert near_box.any()
    assert (points.height[below] > -0.51).all()
    assert ((points.ahead[below] > 1.49) & (points.ahead[below] < 2.41)).all()
    np.testing.assert_allclose(points.ahead[overhead], 5.0, atol=0.01)  # the wall


def test_depths_out_of_range_are_nothing():
    camera = scenes.camera(reach=(0.4, 2.0))
    depth = scenes.depth(camera)
    far = image().pack(0, 1, "optical", depth, camera, "16UC1")
    found = kinds(cloud(far), Bands())
    assert (found[depth > 2000] == Kind.NOTHING).all()
    assert (found[depth <= 2000] == Kind.FLOOR).all()
