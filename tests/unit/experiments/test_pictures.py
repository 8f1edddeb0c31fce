"""Pictures are written, of the size asked for, and show something."""

import numpy as np
import pytest
from PIL import Image

from cliffscan.simulator.world import World
from evaluation.pictures.cloud import Bands, cloud
from evaluation.pictures.plan import LEAST, extent_of
from evaluation.pictures.sheet import DPI, WIDTH
from experiments.pictures import FIGURES, recorded_picture, world_pictures
from tests.unit.experiments.made_up import blank_frame, frame


def pixels(path, columns):
    with Image.open(path) as picture:
        assert picture.format == "PNG"
        assert picture.width == round(columns * WIDTH * DPI)
        return np.asarray(picture.convert("RGB"))


def test_a_world_has_a_picture_for_each_group_of_figures(tmp_path):
    paths = world_pictures(tmp_path, World("paper_room"), frame(), Bands())
    assert [path.name for path in paths] == ["paper_room_depth.png", "paper_room_points.png", "paper_room_scans.png"]
    for path, columns in zip(paths, (2, 2, 3), strict=True):
        assert len(np.unique(pixels(path, columns) @ [1 << 16, 1 << 8, 1])) > 50  # colours


@pytest.mark.parametrize("made", [frame, blank_frame], ids=["a scene", "nothing seen"])
def test_a_recorded_frame_has_one_picture(tmp_path, made):
    path = recorded_picture(tmp_path / "frame.png", "a folder, a frame", made(), Bands())
    assert pixels(path, 3).std() > 10


def test_the_papers_figures_are_each_named_once():
    assert sorted(number for by_what in FIGURES.values() for number in by_what.values()) == list(range(11, 23))


def test_a_picture_shows_all_that_the_scans_report():
    depth, scans = frame("open floor")
    extent = extent_of(cloud(depth), list(scans.values()))
    assert 5.0 < extent.ahead < 6.0  # the wall at 5 m
    assert extent.aside > 2.5  # the border of the field of view, 29° from ahead


def test_a_picture_of_nothing_still_shows_the_robots_surroundings():
    depth, scans = blank_frame()
    assert extent_of(cloud(depth), list(scans.values())).ahead == LEAST
