"""The files are what ROS `map_server` reads."""

import numpy as np

from examples.slam import map_files
from examples.slam.wire import Map

CELLS = np.array([[-1, 0, 100], [25, 26, 65]], np.int8)
GRID = Map(0.05, -1.25, 2.5, CELLS)


def test_the_first_row_of_the_picture_is_the_highest_y():
    header, pixels = map_files.pgm(GRID).split(b"255\n")
    assert header == b"P5\n3 2\n"
    assert list(pixels) == [254, 205, 0, 205, 254, 0]


def test_the_page_says_where_the_picture_lies():
    assert map_files.yaml(GRID, "map.pgm").splitlines() == [
        "image: map.pgm",
        "mode: trinary",
        "resolution: 0.05",
        "origin: [-1.25, 2.5, 0.0]",
        "negate: 0",
        "occupied_thresh: 0.65",
        "free_thresh: 0.196",
    ]


def test_map_server_gets_back_free_occupied_and_unknown():
    """Its rule: occupied above the one threshold, free below the other, else unknown."""
    occupied = (255 - map_files.grey(CELLS).astype(float)) / 255
    read = np.where(occupied > 0.65, 100, np.where(occupied < 0.196, 0, -1))
    assert read.tolist() == [[-1, 0, 100], [0, -1, 100]]


def test_files_are_replaced_whole(tmp_path):
    folder = tmp_path / "new" / "maps"
    for _ in range(2):
        map_files.save(GRID, folder)
    assert sorted(path.name for path in folder.iterdir()) == ["map.pgm", "map.yaml"]
    assert (folder / "map.pgm").read_bytes() == map_files.pgm(GRID)
