"""Frames cross a socket whole, however the stream is cut; the newest wins."""

import json
import socket
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer
from cliffscan.simulator.wire import FrameReader, WireError

DEADLINE = 60.0  # [s]
DEPTH = np.arange(12, dtype=np.uint16).reshape(3, 4) * 1000
HEADER = {"seq": 7, "truth": {"pose": [0.5, 0.0, -1.0]}}


def packed(header):
    told = json.dumps(header).encode() if not isinstance(header, bytes) else header
    return len(told).to_bytes(4, "little") + told


@given(cuts=st.lists(st.integers(0, 400), max_size=8))
def test_frames_come_out_however_the_stream_is_cut(cuts):
    stream = wire.pack(HEADER, DEPTH) + wire.pack({"seq": 8}, DEPTH.T)
    places = [0, *sorted(cuts), len(stream)]
    reader = FrameReader()
    found = [frame for a, b in pairwise(places) for frame in reader.feed(stream[a:b])]
    assert [frame.header["seq"] for frame in found] == [7, 8]
    assert found[0].header == HEADER | {"width": 4, "height": 3}
    np.testing.assert_array_equal(found[0].depth, DEPTH)
    np.testing.assert_array_equal(found[1].depth, DEPTH.T)


def test_the_bytes_are_as_documented():
    data = wire.pack({}, np.array([[1, 0x0203]], np.uint16))
    size = int.from_bytes(data[:4], "little")
    assert json.loads(data[4 : 4 + size]) == {"width": 2, "height": 1}
    assert data[4 + size :] == b"\x01\x00\x03\x02"


@pytest.mark.parametrize(
    "data",
    [
        b"\xff\xff\xff\xff",
        packed(b"\xaa\x55"),
        packed({"width": 4}),
        packed([1]),
        packed({"width": "x", "height": 2}),
        packed({"width": 0, "height": 2}),
        packed({"width": 10**6, "height": 10**6}),
    ],
)
def test_what_is_no_frame_is_refused(data):
    with pytest.raises(WireError):
        FrameReader().feed(data)


@pytest.mark.parametrize("address", ["nowhere", "host:", ":5", "host:99999", "host:x"])
def test_what_is_no_address_is_refused(address):
    with pytest.raises(WireError, match="no address"):
        wire.connect(address, 1.0)


def received(connection):
    reader = FrameReader()
    connection.settimeout(DEADLINE)
    while True:
        if frames := reader.feed(connection.recv(65536)):
            return frames[0]


@pytest.fixture(params=["path", "port"])
def server(request, tmp_path):
    made = FrameServer(str(tmp_path / "frames") if request.param == "path" else "127.0.0.1:0")
    yield made
    made.close()


def wait_wanted(server, wanted=True):
    """Connecting and leaving are noticed by the server's threads, a moment later."""
    with server._changed:
        assert server._changed.wait_for(lambda: server.wanted == wanted, DEADLINE)


def test_everybody_gets_the_frame(server):
    with wire.connect(server.address, 1.0) as one, wire.connect(server.address, 1.0) as other:
        with server._changed:
            assert server._changed.wait_for(lambda: len(server._connections) == 2, DEADLINE)
        server.offer(wire.pack(HEADER, DEPTH))
        assert received(one).header["seq"] == received(other).header["seq"] == 7


def test_who_comes_late_gets_nothing_old(server):
    server.offer(wire.pack({"seq": 1}, DEPTH))
    with wire.connect(server.address, 1.0) as late:
        wait_wanted(server)
        server.offer(wire.pack({"seq": 2}, DEPTH))
        assert received(late).header["seq"] == 2


def test_a_slow_reader_holds_nobody_up_and_misses_frames(server):
    big = np.zeros((1000, 1000), np.uint16)
    with wire.connect(server.address, 1.0) as slow:
        wait_wanted(server)
        for number in range(50):
            server.offer(wire.pack({"seq": number}, big))  # would take 100 MB of buffers
        reader, seen = FrameReader(), []
        slow.settimeout(DEADLINE)
        while not seen or seen[-1] != 49:
            seen += [frame.header["seq"] for frame in reader.feed(slow.recv(1 << 20))]
    assert len(seen) < 50
    assert seen == sorted(seen)


def test_an_end_is_an_end_for_everybody(tmp_path):
    path = tmp_path / "frames"
    server = FrameServer(str(path))
    with wire.connect(server.address, 1.0) as connection:
        wait_wanted(server)
        server.close()
        connection.settimeout(DEADLINE)
        assert connection.recv(1) == b""
    assert not path.exists()


def test_a_path_left_behind_is_taken_over_but_not_one_in_use(tmp_path):
    path = str(tmp_path / "frames")
    with socket.socket(socket.AF_UNIX) as left:
        left.bind(path)
    server = FrameServer(path)
    with pytest.raises(OSError, match="in use"):
        FrameServer(path)
    server.close()
