"""What is shown together is told apart in grey and by eyes that do not see red and green apart."""

from itertools import combinations
from typing import get_args

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from cliffscan.common.contract.base_messages import Rule
from evaluation import palette

ALL_CONES = np.eye(3)
DEUTERANOPIA = np.array(  # of linear RGB; Machado, Oliveira and Fernandes 2009, severity 1
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
)
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = np.array([0.9505, 1.0, 1.089])
IN_GREY, IN_COLOUR = 10.0, 20.0  # of CIE L*, and of CIE L*a*b*

TOGETHER = {  # what one picture shows side by side, and nothing but its colour tells apart
    "kinds of pixels": [fill.colour for fill in palette.KINDS.values()],
    "pieces of a world": [palette.PIECES[kind].colour for kind in ("lower", "floor", "obstacle")],
    "cells of a map": [fill.colour for fill in palette.CELLS.values()],
    "evidence": [mark.colour for mark in palette.EVIDENCE.values()],
}


def lab(colours, seen_by=ALL_CONES):
    """CIE L*a*b* (n, 3) of colours, as eyes see them that mix linear RGB like that."""
    srgb = np.array([to_rgb(colour) for colour in colours])
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    share = np.clip(linear @ seen_by.T, 0.0, 1.0) @ TO_XYZ.T / WHITE
    x, y, z = np.where(share > 0.008856, np.cbrt(share), 7.787 * share + 16 / 116).T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def least(values):
    """The least distance between any two of (n, k) values."""
    return min(np.linalg.norm(one - other) for one, other in combinations(values, 2))


@pytest.mark.parametrize("name", TOGETHER)
def test_colours_are_told_apart_in_grey(name):
    assert least(lab(TOGETHER[name])[:, :1]) > IN_GREY


@pytest.mark.parametrize("name", TOGETHER)
def test_colours_are_told_apart_without_green(name):
    eyes = lab(TOGETHER[name], DEUTERANOPIA)
    assert least(eyes) > IN_GREY
    assert least(eyes[:, :1]) > IN_GREY / 2


def test_red_and_green_of_one_lightness_are_not_told_apart_by_these_eyes():
    pair = ["#C08030", "#80A030"]
    assert least(lab(pair)) > IN_COLOUR > least(lab(pair, DEUTERANOPIA))


def test_depth_grows_lighter_in_even_steps_and_is_never_black():
    lightness = lab(palette.DEPTH(np.linspace(0.0, 1.0, 33)))[:, 0]
    steps = np.diff(lightness)
    assert lightness[0] > 15.0
    assert 0.5 * steps.mean() < steps.min() <= steps.max() < 2.0 * steps.mean()


@pytest.mark.parametrize("name", ["EVIDENCE", "VERDICTS", "EVENTS"])
def test_every_mark_has_a_marker_of_its_own(name):
    marks = getattr(palette, name)
    assert len({mark.marker for mark in marks.values()}) == len(marks)


def test_lines_of_a_picture_differ_by_more_than_their_hue():
    for style in ("solid", "dashed", "dashdot", "dotted"):
        alike = [stroke.colour for stroke in palette.RULES.values() if stroke.style == style]
        assert least(lab(alike)[:, :1]) > IN_GREY
    edges = [palette.EDGE_SHOWN, palette.EDGE_LOST, palette.EDGE_UNSEEN, palette.WAY]
    assert len({str(stroke.style) for stroke in edges}) == len(edges)


def test_every_rule_of_the_gate_has_a_line():
    assert set(palette.RULES) == set(get_args(Rule))
