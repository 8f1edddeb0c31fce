"""`cliffscan calibrate` measures the mount from what capture sends, or says in one line why it cannot."""

import json
import tomllib

import numpy as np
import pytest
from PIL import Image

from cliffscan.common.contract.camera import FloorPlane
from tests import scenes
from tests.service.test_command import ask

CAMERA = scenes.camera(320, 240, FloorPlane.from_mount(0.30, 0.1), (0.5, 4.5))


@pytest.fixture
def place(client):
    return ["--robot", client.robot, "--connect", client.endpoint, "--mode", "client"]


@pytest.fixture
def play(start, tmp_path):
    """Start a capture that plays one picture, told a mount that is wrong."""

    def begin(depth):
        Image.fromarray(depth).save(tmp_path / "frame.png")
        camera = {"width": 320, "height": 240, "intrinsics": CAMERA.intrinsics, "range": CAMERA.range}
        wrong = FloorPlane.from_mount(0.32, 0.12, 0.02)
        (tmp_path / "camera.json").write_text(json.dumps(camera | {"floor": wrong}))
        settings = ("source=replay", f"path={tmp_path}", "rate=30")
        return start("capture", *(word for each in settings for word in ("--set", f"capture.{each}")))

    return begin


@pytest.mark.parametrize("around", [[], ["--set", "capture.height=0.28", "--set", "capture.pitch=4"]])
def test_the_mount_of_a_floor_is_printed_as_configuration(play, place, around):
    play(scenes.depth(CAMERA, wall=20.0))
    done = ask("calibrate", "--seconds", "0.5", *place, *around)
    assert done.returncode == 0, done.stderr
    mount = tomllib.loads(done.stdout)["capture"]
    assert mount["height"] == pytest.approx(0.30, abs=2e-3)
    assert mount["pitch"] == pytest.approx(np.degrees(0.1), abs=0.1)
    assert mount["roll"] == pytest.approx(0.0, abs=0.1)


def test_a_capture_that_sees_no_floor_says_so_in_its_status_and_is_no_measure(client, play, place):
    status = client.listen("status/capture")
    play(np.full((240, 320), 700, np.uint16))
    told = status.until(lambda each: each["counts"].get("floor_kept", 0))
    assert "floor not seen" in told["note"]
    done = ask("calibrate", "--seconds", "0.5", *place)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.startswith("cliffscan: floor seen in 0 of ")
    assert done.stderr.count("\n") == 1


def test_without_frames_the_remedy_is_told(start, place):
    assert "capture does not run" in ask("calibrate", *place).stderr
    start("capture", "--set", "capture.source=kinect", "--set", "capture.device=99", wait=False)
    done = ask("calibrate", *place)
    assert done.returncode == 1
    assert "capture is waiting: " in done.stderr


@pytest.mark.parametrize("wrong", [["--seconds", "0"], ["--set", "capture.colour=red"]])
def test_wrong_options_are_refused(place, wrong):
    assert ask("calibrate", *place, *wrong).returncode == 2
