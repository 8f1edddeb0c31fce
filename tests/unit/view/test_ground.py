"""The page's grid is the gate's, made of the same inputs."""

import numpy as np
import pytest

from cliffscan.common.contract.base_messages import Odometry, SafetyState
from cliffscan.common.contract.messages import LaserScan
from cliffscan.safety.local_grid import CELL, EDGE, FREE, RollingGrid
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.scan_claims import Scan, View
from cliffscan.view.ground import RADIUS, SHOWN, RememberedGround
from tests.build import odometry_fields, scan_fields

BEAMS = 201
STAMP = 10**18


def odometry(x=0.0, stamp=STAMP):
    return Odometry.of(odometry_fields(stamp=stamp, pose=[x, 0.0, 0.0]))


def edge_at(distance):
    """A scan of floor that ends along a line straight ahead."""
    angles = np.linspace(-0.5, 0.5, BEAMS)
    ranges = (distance / np.cos(angles)).astype("<f4").tobytes()
    drops = np.full(BEAMS, 2, "<f4").tobytes()
    return LaserScan.of(
        scan_fields(stamp=STAMP, angle_increment=1.0 / (BEAMS - 1), ranges=ranges, clear=ranges, intensities=drops)
    )


def held(**changes):
    fields = {"stamp": STAMP, "rule": "obstacle", "distance": 0.87, "asked": (0.2, 0.0), "allowed": (0.0, 0.0)}
    return SafetyState(**(fields | {"latched": False, "note": ""} | changes))


@pytest.fixture
def ground():
    made = RememberedGround()
    made.move(odometry())
    return made


def test_it_has_the_cells_of_the_gate_s_grid(ground):
    seen = edge_at(1.2)
    assert ground.see(seen) == Pose2D(0.0, 0.0, 0.0)
    grid, view = RollingGrid(Pose2D(0.0, 0.0, 0.0), RADIUS), View.undescribed()
    grid.see(*Scan.of(seen, view), view.camera, view.floor)
    ours, theirs = ground.cells(), grid.around(Pose2D(0.0, 0.0, 0.0), SHOWN)
    assert (ours.cells == theirs.cells).all()
    assert (ours.x, ours.y) == (theirs.x, theirs.y)
    assert (ours.cells == EDGE).sum() > 10


def test_a_cell_s_place_is_where_the_robot_stands(ground):
    window = ground.cells()
    row, column = (int((0.0 - start) // CELL) for start in (window.x, window.y))
    assert window.cells[row, column] == FREE


def test_what_the_commanded_way_meets_is_the_edge(ground):
    ground.see(edge_at(1.2))
    met = ground.obstruction(held())
    assert met.kind == "edge"
    assert met.x == pytest.approx(1.2 + View.undescribed().camera.x, abs=0.1)


def test_what_the_gate_saw_before_is_not_guessed(ground):
    ground.see(edge_at(1.2))
    assert ground.obstruction(held(distance=0.1)) is None


def test_nothing_is_met_where_nothing_holds_the_robot(ground):
    ground.see(edge_at(1.2))
    assert ground.obstruction(held(rule="free")) is None
    assert ground.obstruction(held(asked=(0.0, 0.5))) is None


def test_a_reset_odometry_begins_anew(ground):
    ground.see(edge_at(1.2))
    ground.move(odometry(x=5.0, stamp=STAMP + 1))
    assert (ground.cells().cells == EDGE).sum() == 0


def test_without_odometry_there_is_no_grid():
    assert RememberedGround().cells() is None
    assert RememberedGround().see(edge_at(1.2)) is None
