"""A recording: every frame that can be used is counted, some are drawn, and what cannot is told."""

import io
import json

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.stop_signal import StopSignal
from experiments import recording as experiment
from experiments.recording import run_recording
from experiments.run import Run
from tests import scenes
from tests.own_recordings import record

CAMERA = scenes.camera()
DEPTHS = [scenes.depth(CAMERA, wall=wall) for wall in (2.0, 2.5, 3.0, 3.5)]


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "frames"
    made.mkdir()
    for number, depth in enumerate(DEPTHS):
        Image.fromarray(depth).save(made / f"f{number}.png")
    told = {"width": CAMERA.width, "height": CAMERA.height, "intrinsics": CAMERA.intrinsics, "range": CAMERA.range}
    (made / "camera.json").write_text(json.dumps({**told, "floor": CAMERA.floor}))
    return made


@pytest.fixture
def run(tmp_path):
    made = Run(Console(file=io.StringIO(), width=100), StopSignal(), tmp_path / "out", [])
    made.out.mkdir()
    return made


def said(run):
    return run.console.file.getvalue()


def drawn(run):
    return sorted(path.stem for path in run.out.glob("*.png"))


def test_of_many_frames_some_are_drawn_evenly_and_all_counted(run, folder, monkeypatch):
    monkeypatch.setattr(experiment, "MOST_PICTURES", 2)
    run_recording(run, folder)
    assert drawn(run) == ["frames_f0", "frames_f3"]
    assert "4 of 4 frames" in (run.out / "frames.md").read_text()


def test_bad_frames_are_left_out_and_told(run, folder, monkeypatch):
    monkeypatch.setattr(experiment, "MOST_PICTURES", 0)
    (folder / "f1.png").write_bytes((folder / "f1.png").read_bytes()[:60])
    Image.fromarray(np.zeros((5, 5), np.uint16)).save(folder / "f2.png")
    run_recording(run, folder)
    assert all(f"leaving out {name}" in said(run) for name in ("f1.png", "f2.png"))
    assert "2 of 4 frames" in (run.out / "frames.md").read_text()


def test_a_folder_without_a_usable_frame_is_refused(run, folder):
    for png in folder.glob("*.png"):
        png.write_bytes(b"")
    with pytest.raises(ConfigError, match="no usable image in it"):
        run_recording(run, folder)
    for png in folder.glob("*.png"):
        png.unlink()
    with pytest.raises(ConfigError, match="no PNG in it"):
        run_recording(run, folder)
    (folder / "camera.json").unlink()
    with pytest.raises(ConfigError, match=r"camera\.json: No such file"):
        run_recording(run, folder)


@pytest.mark.parametrize("text", ["scan.beams=none", "positive.robot_height=no", "fuse.timeout=-1"])
def test_what_the_services_would_refuse_is_refused(run, folder, text):
    run.overrides.append(text)
    with pytest.raises(ConfigError):
        run_recording(run, folder)


@pytest.mark.parametrize("kind", ["bag", "sqlite", "mcap of its project"])
def test_a_recording_of_ros_is_counted_but_for_what_is_damaged(run, tmp_path, monkeypatch, kind):
    monkeypatch.setattr(experiment, "MOST_PICTURES", 0)
    run_recording(run, record(tmp_path, kind, DEPTHS, CAMERA.intrinsics, 0.3, damaged=[1]))
    assert "leaving out a message that cannot be decoded" in said(run)
    assert "3 of 4 frames" in (run.out / "drive.md").read_text()
