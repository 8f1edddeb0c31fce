"""The truth of a world as its robot's camera could see it."""

import math

import numpy as np

from cliffscan.simulator.kinect import RANGE, kinect_camera
from cliffscan.simulator.world import World
from evaluation.truth.sight import measurable
from evaluation.truth.world_truth import TOLERANCE, world_truth

ANGLES = np.radians(np.linspace(-29.0, 29.0, 117))


def test_every_beam_of_the_papers_rooms_has_an_edge_that_the_kinect_can_measure():
    for name in ("paper_room", "paper_room_open"):
        truth = world_truth(World(name), kinect_camera(), ANGLES)
        np.testing.assert_allclose(truth.edge, 1.5 / np.cos(ANGLES))
        assert truth.drop.all()


def test_no_edge_is_within_reach_on_an_open_floor():
    truth = world_truth(World("open_floor"), kinect_camera(), ANGLES)
    assert np.isfinite(truth.edge).all()
    assert not truth.drop.any()
    np.testing.assert_allclose(truth.earliest, truth.edge - TOLERANCE)


def test_the_level_camera_measures_floor_from_its_lowest_row_to_the_end_of_its_range():
    nearest = 0.30 / math.tan(math.radians(22.5))  # [m] seen by the lower border of the image
    distances = np.array([nearest - 0.01, nearest + 0.01, RANGE[1] - 0.01, RANGE[1] + 0.01, np.inf])
    seen = measurable(kinect_camera(), np.zeros(5), distances)
    assert seen.tolist() == [False, True, True, False, False]


def test_a_camera_that_looks_down_measures_nearer_floor():
    angles, distances = np.zeros(1), np.array([0.5])
    assert not measurable(kinect_camera(), angles, distances).any()
    assert measurable(kinect_camera(pitch=math.radians(20)), angles, distances).all()
