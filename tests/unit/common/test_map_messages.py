"""A map has the cells it says it has."""

import numpy as np
import pytest

from cliffscan.common.contract import topics
from cliffscan.common.contract.map_messages import OccupancyGrid, Pose2D
from cliffscan.common.contract.message import MessageError
from cliffscan.show import line
from tests.build import SECOND, payload

CELLS = [-1, 0, 100, 50, 25, 65]
MAP = {
    "stamp": 5 * SECOND,
    "frame": "map",
    "resolution": 0.05,
    "width": 3,
    "height": 2,
    "origin": [-1.0, 2.0, 0.0],
    "data": np.array(CELLS, "<i1").tobytes(),
}


def test_a_map_comes_back_as_it_went():
    grid = OccupancyGrid.decode(payload(MAP))
    assert grid.data.tolist() == CELLS
    assert OccupancyGrid.decode(grid.encode()).encode() == payload(MAP)


def test_a_pose_comes_back_as_it_went():
    fields = {"stamp": 5 * SECOND, "frame": "map", "pose": [1.0, 2.0, 3.0]}
    assert Pose2D.decode(payload(fields)).encode() == payload(fields)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"width": 4}, "expected 4 x 2"),
        ({"width": 0, "data": b""}, "width"),
        ({"width": 1 << 13, "height": 1 << 13}, "more than"),
        ({"data": b"\x65" * 6}, "from -1 to 100"),
        ({"data": b"\xfe" * 6}, "from -1 to 100"),
        ({"resolution": 0.0}, "resolution"),
        ({"origin": [0.0, 0.0]}, "origin"),
    ],
)
def test_a_map_that_contradicts_itself_is_refused(change, word):
    with pytest.raises(MessageError, match=word):
        OccupancyGrid.decode(payload(MAP | change))


def test_maps_and_poses_have_their_keys():
    assert topics.message_at("map") is topics.message_at("map/positive") is topics.MAP.message is OccupancyGrid
    assert topics.message_at("pose") is topics.POSE.message is Pose2D


def test_a_map_is_told_in_a_few_words():
    assert "6 numbers from -1.000 to 100.000" in line(OccupancyGrid.decode(payload(MAP)))
