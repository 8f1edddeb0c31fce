"""A described camera, however it is mounted, frees no floor that none of its pixels can see."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import axes
from cliffscan.common.contract.description import CameraDescription, Place
from cliffscan.safety.local_grid import CELL, FREE, GUESS_REACH, GUESSED, RollingGrid
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.scan_claims import View
from cliffscan.safety.visible_floor import VisibleFloor
from tests import build
from tests.gate_drive import ANGLES, HERE, Drive

BELOW = Place(0.0, 0.0, 0.0)
MOUNTS = [
    (height, math.radians(pitch), math.radians(roll))
    for height in (0.2, 0.3, 0.45, 0.6, 0.9, 1.2)
    for pitch in (-5, 0, 12, 25, 40)
    for roll in (0, 8, -20)
]


def described(height, pitch=0.0, roll=0.0, place=BELOW):
    camera = build.camera(640, 480, 575.8, mount=(height, pitch, roll), centre=(314.5, 235.5))
    return camera, CameraDescription.of(camera, "eye", simulated=False, place=place)


def seen_by_a_pixel(camera, x, y):
    """Whether the floor at x ahead, y left [m] of the point below the camera falls on its image, within its range."""
    forward, left, up = (axis[:, None] for axis in axes(camera.floor))
    right, down, depth = forward * x.ravel() + left * y.ravel() - up * camera.floor.d
    fx, fy, cx, cy = camera.intrinsics
    near, far = camera.range
    with np.errstate(divide="ignore", invalid="ignore"):
        column, row = fx * right / depth + cx, fy * down / depth + cy
    inside = (column >= 0) & (column <= camera.width - 1) & (row >= 0) & (row <= camera.height - 1)
    return inside & (near <= depth) & (depth <= far)


def freed(description, state):
    """Corners (4, n) x and y [m] of the cells that a scan of clear floor, as wide as can be, makes of unknown ones."""
    grid, view = RollingGrid(HERE, 0.0), View.of(description)
    angles = np.radians(np.linspace(-80, 80, 1600))
    free = np.full(len(angles), 20.0)
    grid.see(np.full(len(angles), np.inf), np.zeros(len(angles), bool), free, angles, HERE, view.floor)
    rows, columns = np.nonzero(grid._seen == state)
    x, y = ((place + corner) * CELL for place, corner in zip((rows, columns), grid._corner, strict=True))
    return np.stack([x, x + CELL, x, x + CELL]), np.stack([y, y, y + CELL, y + CELL])


@pytest.mark.parametrize(("height", "pitch", "roll"), MOUNTS)
def test_what_is_free_was_seen_by_pixels_in_all_of_the_cell(height, pitch, roll):
    camera, description = described(height, pitch, roll)
    assert seen_by_a_pixel(camera, *freed(description, FREE)).all()


@pytest.mark.parametrize(("height", "pitch", "roll"), MOUNTS)
def test_what_is_guessed_lies_before_floor_that_pixels_see_soon(height, pitch, roll):
    camera, description = described(height, pitch, roll)
    x, y = (corners.mean(axis=0) for corners in freed(description, GUESSED))
    distance = np.hypot(x, y)
    assert (distance < GUESS_REACH).all()
    assert seen_by_a_pixel(camera, GUESS_REACH * x / distance, GUESS_REACH * y / distance).all()


@pytest.mark.parametrize(("height", "pitch"), [(0.2, 0), (0.3, 0), (0.3, 12), (0.6, 15), (0.9, 30), (1.2, 40)])
def test_a_camera_that_looks_down_as_its_height_asks_frees_what_is_before_the_robot(height, pitch):
    x, y = freed(described(height, math.radians(pitch))[1], FREE)
    ahead = np.abs(y).max(axis=0) < 0.2
    assert x[:, ahead].min() < 0.9
    assert x[:, ahead].max() > 1.3


def test_the_borders_are_the_corners_whichever_way_round_they_go():
    _, description = described(0.3, 0.2, 0.1)
    turned = description.model_copy(update={"visible_floor": description.visible_floor[::-1]})
    x, y = np.random.default_rng(1).uniform(-1.0, 5.0, (2, 500))
    inside = VisibleFloor.of(description).holds(x, y)
    assert 10 < inside.sum() < 490
    np.testing.assert_array_equal(VisibleFloor.of(turned).holds(x, y), inside)


def test_a_camera_without_a_polygon_is_held_to_its_nearest_floor():
    _, high = described(0.6)
    x, y = freed(high.model_copy(update={"visible_floor": ()}), FREE)
    assert np.hypot(x, y).min() >= high.nearest_floor
    assert not freed(high.model_copy(update={"visible_floor": ()}), GUESSED)[0].size


def test_a_camera_that_sees_no_floor_frees_none():
    _, description = described(0.3, math.radians(-40))
    assert not freed(description, FREE)[0].size
    assert not freed(description, GUESSED)[0].size


@pytest.mark.parametrize("height", [0.6, 0.9, 1.2])
def test_a_robot_whose_camera_stands_high_and_level_goes_no_farther_than_it_was_put_down_on_floor(height):
    """A hole from 0.5 m on is hidden from it; without the description it was taken for free."""
    drive = Drive()
    drive.safety.describe(described(height)[1])
    assert drive.go(0.5).x < 0.5 - 0.18
    assert "unseen floor" in str(drive.tick(0.3).obstruction)


def test_a_robot_whose_camera_looks_down_drives_on():
    drive = Drive()
    drive.safety.describe(described(0.6, math.radians(15))[1])
    assert drive.go(0.5).x > 2.0


def test_the_camera_is_where_it_is_described():
    drive = Drive(ranges=np.where(np.abs(ANGLES) < 0.02, 1.0, math.inf))
    drive.safety.describe(described(0.3, place=Place(0.1, -0.2, math.pi / 2))[1])
    drive.tick(0.0)
    x, y = drive.safety._grid.not_free(HERE, 1.4, unknown_too=False)
    assert (x.mean(), y.mean()) == pytest.approx((0.1, 0.8), abs=CELL)
    assert drive.safety.view.camera == Pose2D(0.1, -0.2, math.pi / 2)
