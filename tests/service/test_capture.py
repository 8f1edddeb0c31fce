"""capture plays a depth folder, the simulator and a Kinect's recorded session, compressed and raw."""

import json

import numpy as np
import pytest
from PIL import Image

from common.messages import DepthImage
from tests import scenes
from tests.fakenect_session import library_folder, session_environment, write_session
from tests.service.conftest import intensities, ranges

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
        assert message["seq"] == number
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
    scan = ear.get()
    ahead = slice(310, 330)
    assert ranges(scan)[ahead] == pytest.approx(np.full(20, 1.5), abs=0.03)
    assert set(intensities(scan)[ahead]) <= {2, 3}  # a drop, or floor lost


@pytest.mark.skipif(library_folder() is None, reason="needs Debian's package libfreenect0.5 (libfreenect and fakenect)")
def test_a_kinects_session_is_captured_and_its_end_is_a_lost_device(client, start, tmp_path):
    raw = np.random.default_rng(3).integers(300, 1000, (3, 480, 640), dtype=np.uint16)
    write_session(tmp_path, raw, period=0.03)
    ear, status = client.listen("camera/depth"), client.listen("status/capture")
    settings = ("--set", "capture.source=kinect", "--set", "capture.depth_mode=11bit")
    process = start("capture", *settings, **session_environment(tmp_path))
    assert DepthImage.of(ear.get()).depth.shape == (480, 640)
    process.wait_said("source_lost (1 so far): Kinect 0 is gone")
    told = status.until(lambda each: each["state"] == "waiting")
    assert "Kinect 0 is gone" in told["note"]


def test_a_kinect_that_is_not_there_is_waited_for(start):
    process = start("capture", "--set", "capture.source=kinect", "--set", "capture.device=99", wait=False)
    process.wait_said("trying again in 2 s")
