"""Convex polygons: an area with a hole cut out of it, and lines across it."""

import math

import numpy as np
import pytest

from evaluation.scenes.drops import random_outline
from evaluation.scenes.polygons import around, contains, crossing, direction, rectangle, surface
from evaluation.scenes.scene import GROUND

SQUARE = rectangle(np.array([2.0, 0.0]), 2.0, 2.0, 0.0)
ORIGIN = np.zeros(2)


@pytest.mark.parametrize("seed", range(20))
def test_a_hole_and_the_pieces_around_it_cover_the_area_once(seed):
    rng = np.random.default_rng(seed)
    hole = random_outline(rng) + np.array([3.0, 0.0])
    pieces = around(GROUND, hole)
    spots = rng.uniform((1.0, -2.0), (5.0, 2.0), (200, 2))
    assert np.sum([contains(piece, spots) for piece in (hole, *pieces)], axis=0) == pytest.approx(1)
    assert sum(map(surface, (hole, *pieces))) == pytest.approx(surface(GROUND))


def test_line_enters_and_leaves():
    enter, leave = crossing(SQUARE, ORIGIN, np.array([[1.0, 0.0], [0.0, 1.0], [math.cos(0.1), math.sin(0.1)]]))
    assert enter == pytest.approx([1.0, math.inf, 1.0 / math.cos(0.1)])
    assert leave == pytest.approx([3.0, -math.inf, 3.0 / math.cos(0.1)])


def test_crossing_agrees_with_contains():
    rng = np.random.default_rng(1)
    for _ in range(20):
        outline = random_outline(rng) + direction(rng.uniform(-1, 1)) * rng.uniform(0.5, 3.0)
        steps = np.stack([direction(angle) for angle in rng.uniform(-1.5, 1.5, 50)])
        enter, leave = crossing(outline, ORIGIN, steps)
        for distance in (0.3, 1.0, 2.0, 3.0):
            assert np.array_equal(contains(outline, steps * distance), (enter <= distance) & (distance <= leave))
