"""capture plays a depth folder, the simulator and a Kinect's recorded session, compressed and raw."""

import json
import threading
import time

import msgpack
import numpy as np
import pytest
from PIL import Image

from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.capture.depth_publisher import THIN
from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer
from tests import scenes
from tests.fakenect_session import library_folder, session_environment, write_session
from tests.service.conftest import DEADLINE, intensities, ranges, scan

CAMERA = scenes.camera()
FRAMES = [scenes.depth(CAMERA, wall=wall) for wall in (2.0, 3.0, 4.0)]


@pytest.fixture
def folder(tmp_path):
    for number, depth in enumerate(FRAMES):
        Image.fromarray(depth).save(tmp_path / f"frame_{number}.png")
    camera = {
        "width": CAMERA.width,
        "height": CAMERA.height,
        "intrinsics": list(CAMERA.intrinsics),
        "range": list(CAMERA.range),
        "floor": list(CAMERA.floor),
        "frames": {"frame_1": {"floor": [0.0, -0.8, -0.6, 0.5]}},
    }
    (tmp_path / "camera.json").write_text(json.dumps(camera))
    return tmp_path


def replay(folder, **settings):
    settings = {"source": "replay", "path": folder} | settings
    return [word for key, value in settings.items() for word in ("--set", f"capture.{key}={value}")]


@pytest.mark.parametrize("compressed", ["true", "false"])
def test_a_folder_is_played_once_whole_and_in_order(client, start, folder, compressed):
    ear = client.listen("camera/depth")
    settings = {"compressed": compressed, "floor": "fixed", "loop": "false", "rate": 100}
    process = start("capture", *replay(folder, **settings), wait=False)
    for number, depth in enumerate(FRAMES):
        message = ear.get()
        assert (message["seq"], message["period"]) == (number, 0.01)
        assert (message["encoding"] == "16UC1") == (compressed == "false")
        assert message["floor"] == ([0.0, -0.8, -0.6, 0.5] if number == 1 else list(CAMERA.floor))
        np.testing.assert_array_equal(DepthImage.of(message).depth, depth)
    assert process.end() == 0


def test_bad_pictures_are_counted_and_passed_over(client, start, folder):
    (folder / "frame_1.png").write_bytes((folder / "frame_1.png").read_bytes()[:-60])
    Image.fromarray(FRAMES[0][:10]).save(folder / "frame_1b.png")
    ear, status = client.listen("camera/depth"), client.listen("status/capture")
    process = start("capture", *replay(folder, rate=50))
    for number in range(6):
        np.testing.assert_array_equal(DepthImage.of(ear.get()).depth, FRAMES[(0, 2)[number % 2]])
    status.until(lambda each: each["counts"].get("bad_frame", 0) >= 4)
    process.wait_said("bad_frame (1 so far): frame_1.png: ")


def test_the_simulated_room_comes_out_as_a_fused_scan(client, start):
    for service in ("negative", "positive", "fuse"):
        start(service, wait=False)
    for service in ("negative", "positive", "fuse"):
        client.wait_alive(service)
    ear = client.listen("scan/fused")
    start("capture", "--set", "capture.source=simulator", "--set", "capture.rate=5")
    fused = ear.get()
    ahead = slice(310, 330)
    assert ranges(fused)[ahead] == pytest.approx(np.full(20, 1.5), abs=0.03)
    assert set(intensities(fused)[ahead]) <= {2, 3}  # a drop, or floor lost


class HangingCamera:
    """A simulation's frames at 30 Hz, each with a fresh stamp; while it hangs, all of one picture."""

    def __init__(self, address) -> None:
        self.hangs = threading.Event()
        self.fresh = set()  # stamps [ns] of pictures that are no repeats
        self._server = FrameServer(address)
        self._ended = threading.Event()
        self._rng = np.random.default_rng(5)
        self._sender = threading.Thread(target=self._send)
        self._sender.start()

    def _send(self):
        header = {"intrinsics": CAMERA.intrinsics, "range": CAMERA.range, "noise": 0.002, "baseline": 0.05}
        depth = FRAMES[1]
        while not self._ended.wait(1 / 30):
            stamp = time.time_ns()
            if not self.hangs.is_set():
                depth = FRAMES[1] + self._rng.integers(0, 4, FRAMES[1].shape, dtype=np.uint16)
                self.fresh.add(stamp)
            self._server.offer(wire.pack(header | {"stamp": stamp}, depth))

    def close(self):
        self._ended.set()
        self._sender.join()
        self._server.close()


@pytest.fixture
def hanging_camera(tmp_path):
    address = str(tmp_path / "frames")
    made = HangingCamera(address)
    yield made, ("--set", "capture.source=simulator", "--set", f"capture.simulation={address}")
    made.close()


def test_a_camera_that_hangs_is_not_published_as_fresh_and_given_up_until_it_sees_again(client, start, hanging_camera):
    camera, options = hanging_camera
    frames, status = client.listen("camera/depth"), client.listen("status/capture")
    process = start("capture", *options)
    frames.get()
    camera.hangs.set()
    client.wait_alive("capture", alive=False)
    told = status.until(lambda each: each["state"] == "waiting")
    assert "repeats its last picture" in told["note"]
    assert told["counts"]["frozen"] > 1
    process.wait_said("source_lost (2 so far): the camera repeats its last picture")  # the device was opened again
    assert {each["stamp"] for each in frames.all()} <= camera.fresh
    camera.hangs.clear()
    client.wait_alive("capture")
    assert frames.get()["stamp"] > told["stamp"]
    assert status.until(lambda each: each["state"] == "working")["note"] != told["note"]


def test_the_camera_is_described_once_and_to_whoever_asks(client, start, hanging_camera):
    _, options = hanging_camera
    described, frames = client.listen("description"), client.listen("camera/depth")
    start("capture", *options, "--set", "capture.height=0.4", "--set", "capture.frame=eye")
    told = described.get()
    assert (told["camera"]["frame"], told["camera"]["simulated"]) == ("eye", True)
    last_row = (CAMERA.height - 1 - CAMERA.intrinsics.cy) / CAMERA.intrinsics.fy
    assert told["camera"]["nearest_floor"] == pytest.approx(0.4 / last_row)
    for _ in range(45):  # more than the second in which it would not be told again
        assert frames.get()["frame"] == "eye"
    assert described.all() == []
    (reply,) = client.session.get(f"{client.robot}/description", timeout=DEADLINE)
    assert msgpack.unpackb(reply.ok.payload.to_bytes()) == told
    assert str(reply.ok.encoding) == "application/msgpack;cliffscan.RobotDescription.v1"


@pytest.mark.skipif(library_folder() is None, reason="needs Debian's package libfreenect0.5 (libfreenect and fakenect)")
def test_a_kinects_session_is_captured_and_its_end_is_a_lost_device(client, start, tmp_path):
    raw = np.random.default_rng(3).integers(300, 1000, (3, 480, 640), dtype=np.uint16)
    write_session(tmp_path, raw, period=0.03)
    ear, status = client.listen("camera/depth"), client.listen("status/capture")
    settings = ("--set", "capture.source=kinect", "--set", "capture.depth_mode=11bit")
    process = start("capture", *settings, **session_environment(tmp_path))
    assert DepthImage.of(ear.get()).depth.shape == (480, 640)
    process.wait_said("source_lost (1 so far): Kinect 0 is gone")
    client.wait_alive("capture", alive=False)
    told = status.until(lambda each: each["state"] == "waiting")
    assert "Kinect 0 is gone" in told["note"]


@pytest.mark.skipif(library_folder() is None, reason="needs Debian's package libfreenect0.5 (libfreenect and fakenect)")
def test_a_kinect_that_repeats_its_picture_is_a_lost_device(client, start, tmp_path):
    raw = np.random.default_rng(3).integers(300, 1000, (480, 640), dtype=np.uint16)
    write_session(tmp_path, [raw] * 60, period=0.03)
    ear = client.listen("camera/depth")
    settings = ("--set", "capture.source=kinect", "--set", "capture.depth_mode=11bit")
    process = start("capture", *settings, **session_environment(tmp_path))
    process.wait_said("source_lost (1 so far): the camera repeats its last picture")
    client.wait_alive("capture", alive=False)
    ear.get()
    assert ear.all() == []


def test_a_kinect_that_is_not_there_is_waited_for(client, start):
    process = start("capture", "--set", "capture.source=kinect", "--set", "capture.device=99", wait=False)
    process.wait_said("trying again in 2 s")
    assert list(client.session.liveliness().get(f"{client.robot}/alive/capture")) == []


def test_frames_become_smaller_where_their_scans_come_late(client, start):
    ear, status = client.listen("camera/depth"), client.listen("status/capture")
    start("capture", "--set", "capture.source=simulator", "--set", "capture.rate=10")
    sent = ear.get()
    while sent["width"] > 213:
        last, sent = sent, ear.get()
        client.put("scan/fused", scan([1.0, 2.0], last["stamp"], seq=last["seq"]))
    assert (sent["width"], sent["intrinsics"][0]) == (213, pytest.approx(192.4, abs=0.1))
    DepthImage.of(sent)
    status.until(lambda each: each["note"] == THIN.format(3))
