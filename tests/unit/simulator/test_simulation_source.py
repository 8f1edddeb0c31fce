"""capture reads a simulation's frames, and knows when it has lost it."""

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.sources import simulation
from cliffscan.services.capture.sources.depth_source import BadFrame, SourceLost
from cliffscan.services.capture.sources.simulation import Simulation
from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer

DEADLINE = 60.0  # [s]
FLOOR = FloorPlane.from_mount(0.31, 0.1)
DEPTH = np.full((480, 640), 1234, np.uint16)
HEADER = {
    "seq": 3,
    "stamp": 1_700_000_000_123_456_789,
    "intrinsics": [577.0, 579.0, 319.5, 239.5],
    "range": [0.5, 4.5],
} | {"noise": 0.002, "baseline": 0.06}


@pytest.fixture
def server(tmp_path):
    made = FrameServer(str(tmp_path / "frames"))
    yield made
    made.close()


@pytest.fixture
def source(server):
    made = Simulation(server.address, FLOOR)
    with server._changed:
        assert server._changed.wait_for(lambda: server.wanted, DEADLINE)
    yield made
    made.close()


def test_a_frame_arrives_with_its_stamp_and_the_mounts_floor(server, source):
    server.offer(wire.pack(HEADER, DEPTH))
    depth, stamp, camera, *_ = source.read(DEADLINE)
    np.testing.assert_array_equal(depth, DEPTH)
    assert stamp == HEADER["stamp"]
    assert (camera.width, camera.height, camera.range, camera.floor) == (640, 480, (0.5, 4.5), FLOOR)
    assert list(camera.intrinsics) == HEADER["intrinsics"]
    assert (camera.noise, camera.baseline) == (HEADER["noise"], HEADER["baseline"])


def test_no_frame_in_time_is_none(source):
    assert source.read(0.01) is None


def test_a_silent_simulation_is_lost(source, monkeypatch):
    monkeypatch.setattr(simulation, "SILENCE", 0.0)
    with pytest.raises(SourceLost, match="silent"):
        source.read(0.01)


def test_a_simulation_that_ends_is_lost(tmp_path):
    server = FrameServer(str(tmp_path / "frames"))
    source = Simulation(server.address, FLOOR)
    server.close()
    with pytest.raises(SourceLost, match=r"has ended|is lost"):
        source.read(DEADLINE)
    source.close()


def test_what_speaks_something_else_is_lost(server, source):
    server.offer(b"\xff" * 100)
    with pytest.raises(SourceLost, match="header of"):
        source.read(DEADLINE)


@pytest.mark.parametrize("wrong", [{"stamp": "now"}, {"intrinsics": [1.0]}, {"range": [5.0, 1.0]}, {"range": None}])
def test_a_frame_that_no_camera_takes_is_bad(server, source, wrong):
    server.offer(wire.pack(HEADER | wrong, DEPTH))
    with pytest.raises(BadFrame):
        source.read(DEADLINE)


def test_a_simulation_that_is_not_there_is_lost_and_told_how_to_start(tmp_path):
    with pytest.raises(SourceLost, match="start python -m simulator"):
        Simulation(str(tmp_path / "nothing"), FLOOR)


def test_what_is_no_address_is_refused():
    with pytest.raises(ConfigError, match=r"capture\.simulation: 'nowhere'"):
        Simulation("nowhere", FLOOR)
