"""The physical simulation as its users have it: a port for kobuki, frames for capture, and the truth on a socket."""

import json
import sys

import numpy as np
import pytest

from cliffscan.common.contract.messages import DepthImage
from cliffscan.simulator.kobuki.client import Remote
from tests.service.conftest import DEADLINE, free_endpoint, wait_until


class Simulator:
    """A running simulation."""

    def __init__(self, process, folder) -> None:
        self.process = process
        self.port, self.frames = str(folder / "kobuki"), str(folder / "frames")
        self.remote = Remote(folder / "control", DEADLINE)

    def truth(self):
        return json.loads(self.remote.tell("truth"))


@pytest.fixture
def simulate(run, tmp_path):
    def begin(world, *options):
        ends = [
            f"--{end}={tmp_path / name}"
            for end, name in (("link", "kobuki"), ("frames", "frames"), ("control", "control"))
        ]
        process = run([sys.executable, "-m", "simulator", "--world", world, *ends, *options])
        process.wait_said("ready")
        return Simulator(process, tmp_path)

    return begin


def looking_at(simulator):
    """The options of a capture that receives a simulation's frames."""
    return "--set", "capture.source=simulator", "--set", f"capture.simulation={simulator.frames}"


def test_the_robot_drives_and_its_camera_goes_with_it(client, start, simulate):
    simulator = simulate("empty_room")
    start("kobuki", "--set", f"kobuki.port={simulator.port}", "--set", "kobuki.require_scan=false")
    start("capture", *looking_at(simulator), "--set", "capture.floor=fixed")
    frames, odometry = client.listen("camera/depth"), client.listen("base/odom")

    def ahead():
        """Depth [m] of the wall straight ahead, and the frame's stamp."""
        image = DepthImage.of(frames.get())
        middle = image.depth[230:250, 310:330]
        return float(np.median(middle[middle > 0])) / 1000, image.stamp

    first, _ = ahead()
    assert first == pytest.approx(4.087, abs=0.05)
    told = odometry.get()
    while told["pose"][0] < 0.5:
        client.put("base/cmd_vel", {"stamp": told["stamp"], "linear": 0.3, "angular": 0.0})
        told = odometry.get()
    last, stamp = first, 0
    while stamp < told["stamp"]:
        last, stamp = ahead()
    at = odometry.until(lambda each: each["stamp"] >= stamp)["pose"][0]
    x, y, yaw = simulator.truth()["pose"]
    assert last == pytest.approx(first - at, abs=0.15)
    assert x >= 0.5 - 0.02
    assert (y, yaw) == pytest.approx((0.0, 0.0), abs=0.05)


def test_a_bump_and_a_fall_reach_the_driver(client, start, simulate):
    simulator = simulate("paper_room", "--start", "1.28", "0", "0")
    start("kobuki", "--set", f"kobuki.port={simulator.port}", "--set", "kobuki.require_scan=false")
    states = client.listen("base/state")
    told = states.get()
    assert not any(told["cliffs"])
    simulator.remote.tell("place 1.42 0.3 0")
    told = states.until(lambda each: all(each["cliffs"]))
    simulator.remote.tell("place 2.5 0 0")
    states.until(lambda each: all(each["wheel_drops"]))
    wait_until(lambda: simulator.truth()["fallen"])
    simulator.remote.tell("place -1.21 0 180")
    states.until(lambda each: not any(each["wheel_drops"]) and not any(each["cliffs"]))
    assert not simulator.truth()["fallen"]


def test_a_simulation_that_ends_is_waited_for(client, start, simulate):
    simulator = simulate("empty_room")
    process = start("capture", *looking_at(simulator))
    frames, status = client.listen("camera/depth"), client.listen("status/capture")
    frames.get()
    simulator.process.signal(15)
    assert simulator.process.end() == 0
    client.wait_alive("capture", alive=False)
    assert simulator.frames in status.until(lambda each: each["state"] == "waiting")["note"]
    process.wait_said(f"source_lost (1 so far): the simulation at {simulator.frames} has ended; trying again")
    frames.all()
    simulate("empty_room")
    client.wait_alive("capture")
    frames.get()


def test_an_unknown_world_is_refused(run, tmp_path):
    process = run([sys.executable, "-m", "simulator", "--world", "atlantis", "--link", str(tmp_path / "kobuki")])
    process.expected = 2
    assert process.end() == 2
    assert "simulator: no world is named 'atlantis'" in process.said


def test_up_refuses_an_unknown_world(run):
    process = run([sys.executable, "-m", "cliffscan", "up", "--world", "atlantis", "--listen", free_endpoint()])
    process.expected = 2
    assert process.end() == 2
    assert "no world is named 'atlantis'" in process.said
