"""SLAM plug-ins as real processes: scans and odometry in, a map and a pose out, map files at the end."""

import math
import signal
import sys
import time

import numpy as np
import pytest

from cliffscan.common.contract.map_messages import OccupancyGrid
from examples.slam import map_files
from tests.service.conftest import DEADLINE
from tests.unit.examples import page
from tests.unit.examples.room import ROOM, START, Pose, Room, box, drifting, lap, odometry_fields, scan_fields

MAPPERS = ["odometry_map", "yag"]
PERIOD = 100_000_000  # [ns] between two scans
FREE, OCCUPIED, UNKNOWN = 254, 0, 205


@pytest.fixture
def plug_in(client, run):
    """Start a plug-in of the examples and wait until it is ready."""

    def begin(mapper, *options, alive="slam"):
        if mapper == "yag":
            pytest.importorskip("yag_slam")
        words = ["--robot", client.robot, "--mode", "client", "--connect", client.endpoint]
        process = run([sys.executable, "-m", f"examples.slam.{mapper}", *words, *map(str, options)])
        client.wait_alive(alive)
        return process

    return begin


def drive(client, room, truth, odometry, scan="scan/fused", pose="pose"):
    """Send each scan with its odometry; the poses that come back."""
    ear = client.listen(pose)
    for number, (at, told) in enumerate(zip(truth, odometry, strict=True)):
        stamp = START + number * PERIOD
        client.put("base/odom", odometry_fields(told, stamp))
        client.put(scan, room.scan(at, stamp))
        answer = ear.get()
        assert (answer["stamp"], answer["frame"]) == (stamp, "map")
        yield Pose(*answer["pose"])


def picture(folder):
    """The pixels of the saved map, as map_server's reader has them: the first row is the top."""
    header, pixels = (folder / "map.pgm").read_bytes().split(b"\n255\n", 1)
    width, height = map(int, header.split()[1:])
    return np.frombuffer(pixels, np.uint8).reshape(height, width)


def grid_of(message):
    return OccupancyGrid.of(message).data.reshape(message["height"], message["width"])


@pytest.mark.parametrize("mapper", MAPPERS)
def test_a_drive_becomes_a_map_and_its_files(client, plug_in, tmp_path, mapper):
    process = plug_in(mapper, "--out", tmp_path / "maps")
    maps, truth = client.listen("map"), list(lap())
    assert len(list(drive(client, ROOM, truth, truth))) == len(truth)
    last = maps.until(lambda grid: grid["stamp"] == START + (len(truth) - 1) * PERIOD)
    cells = grid_of(last)
    rows, columns = np.nonzero(cells >= 65)
    x, y = last["origin"][0] + (columns + 0.5) * 0.05, last["origin"][1] + (rows + 0.5) * 0.05
    assert np.percentile(ROOM.distance(x, y), 90) < (0.05 if mapper == "odometry_map" else 0.12)

    process.signal(signal.SIGTERM)
    assert process.end() == 0
    assert picture(tmp_path / "maps").tolist() == map_files.grey(cells)[::-1].tolist()
    told = (tmp_path / "maps" / "map.yaml").read_text()
    assert f"origin: [{last['origin'][0]!r}, {last['origin'][1]!r}, 0.0]" in told
    assert "image: map.pgm" in told


def test_yag_is_nearer_to_the_truth_than_odometry(client, plug_in):
    plug_in("yag")
    truth = list(lap())
    odometry = list(drifting(truth))
    poses = list(drive(client, ROOM, truth, odometry))

    def off(told):
        return math.sqrt(np.mean([math.dist(one[:2], true[:2]) ** 2 for one, true in zip(told, truth, strict=True)]))

    assert off(poses) < off(odometry) / 2


def test_stairs_are_an_obstacle_in_the_picture(client, plug_in, tmp_path):
    room = Room(box(-3, -3, 3, 3), edges=[(1.525, -3, 1.525, 3)])
    process = plug_in("odometry_map", "--out", tmp_path)
    poses = [Pose(-1.0 + 0.05 * step, 0.0, 0.0) for step in range(10)]
    list(drive(client, room, poses, poses))
    process.signal(signal.SIGINT)
    assert process.end() == 0
    pixels = picture(tmp_path)
    stairs = (pixels == OCCUPIED).sum(axis=0).argmax()
    assert (pixels[:, stairs] == OCCUPIED).sum() > 40
    assert set(pixels[:, stairs + 1 :].ravel()) == {UNKNOWN}
    assert (pixels[:, :stairs] == FREE).sum() > 500


def test_another_scan_makes_a_map_of_its_own_name(client, plug_in):
    plug_in("odometry_map", "--scan", "scan/positive", "--name", "positive", alive="slam-positive")
    maps = client.listen("map/positive")
    assert list(drive(client, ROOM, [Pose(0, -1.6, 0)], [Pose(1, 2, 3)], "scan/positive", "pose/positive"))
    assert grid_of(maps.get()).any()


def test_the_map_is_saved_in_between(client, plug_in, tmp_path):
    process = plug_in("odometry_map", "--out", tmp_path, "--every", 0.01)
    list(drive(client, ROOM, [Pose(0, -1.6, 0)], [Pose(0, -1.6, 0)]))
    process.wait_said("map saved")
    assert (picture(tmp_path) == OCCUPIED).any()


def test_bad_samples_are_told_and_do_no_harm(client, plug_in):
    process = plug_in("odometry_map")
    for path in ("base/odom", "scan/fused"):
        client.put(path, b"\xc1")
    process.wait_said("dropped a bad sample")
    assert len(list(drive(client, ROOM, [Pose(0, -1.6, 0)], [Pose()]))) == 1


def test_a_scan_begins_where_the_camera_is_described(client, start, plug_in):
    start("capture", "--set", "capture.source=simulator", "--set", "capture.x=0.5", "--set", "capture.rate=2")
    plug_in("odometry_map")
    maps, wall, deadline = client.listen("map"), False, time.monotonic() + DEADLINE
    while not wall and time.monotonic() < deadline:
        stamp = time.time_ns()
        client.put("base/odom", odometry_fields(Pose(), stamp))
        client.put("scan/fused", scan_fields([math.nan, 1.01, math.nan], [0.0, 1.0, 0.0], stamp))
        if grid := maps.get_within(0.1):
            column = math.floor((1.51 - grid["origin"][0]) / grid["resolution"])
            wall = column < grid["width"] and (grid_of(grid)[:, column] >= 65).any()
    assert wall


def test_without_yag_slam_it_says_how_to_get_it(run, tmp_path):
    (tmp_path / "yag_slam.py").write_text("raise ModuleNotFoundError(\"No module named 'yag_slam'\")")
    process = run([sys.executable, "-m", "examples.slam.yag"], PYTHONPATH=str(tmp_path))
    process.expected = 2
    assert process.end() == 2
    assert len(process.said.splitlines()) == 1
    assert "pip install yag-slam" in process.said


def test_a_plug_in_waits_for_its_router_and_ends_when_told(run):
    words = ["--mode", "client", "--connect", "tcp/127.0.0.1:1"]
    process = run([sys.executable, "-m", "examples.slam.odometry_map", *words])
    process.wait_said("waiting for a router")


def test_the_program_on_the_page_makes_a_map(client, run, tmp_path):
    program = tmp_path / "my_slam.py"
    program.write_text(page.program())
    process = run([sys.executable, program, client.robot, client.endpoint])
    process.expected = -signal.SIGTERM
    client.wait_alive("slam")
    maps, truth = client.listen("map"), Pose(1.0, -1.6, 0.5)
    assert list(drive(client, ROOM, [truth], [truth])) == [pytest.approx(truth)]
    message = maps.get()
    cells = grid_of(message)
    rows, columns = np.nonzero(cells == 100)
    x, y = message["origin"][0] + (columns + 0.5) * 0.05, message["origin"][1] + (rows + 0.5) * 0.05
    assert ROOM.distance(x, y).max() < 0.05
    assert (cells == 0).sum() > 500
