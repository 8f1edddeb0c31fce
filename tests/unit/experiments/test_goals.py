"""What is collected: the first frames, or every frame of a folder, known again by its content."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image

from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.runtime.config import ConfigError
from experiments.frames import Frame
from experiments.goals import FASTEST, SLOWEST, EveryFrame, FirstFrames
from tests import scenes

CAMERA = scenes.camera()
DEPTHS = [scenes.depth(CAMERA, wall=wall) for wall in (2.0, 2.5, 3.0, 3.5)]


@pytest.fixture
def folder(tmp_path):
    for number, depth in enumerate(DEPTHS):
        Image.fromarray(depth).save(tmp_path / f"f{number}.png")
    (tmp_path / "camera.json").write_text(
        json.dumps(
            {
                "width": CAMERA.width,
                "height": CAMERA.height,
                "intrinsics": CAMERA.intrinsics,
                "range": CAMERA.range,
                "floor": CAMERA.floor,
            }
        )
    )
    return tmp_path


def played(number, seq=0):
    return Frame(DepthImage.pack(seq, seq, "optical", DEPTHS[number], CAMERA, RAW), {"scan/fused": number})


def test_the_first_frames():
    goal = FirstFrames(2)
    for number in range(3):
        goal.take(played(number))
    assert goal.done == goal.total == 2
    assert [frame.scans["scan/fused"] for frame in goal.frames] == [0, 1]


def test_every_frame_is_known_by_its_content_whatever_its_number(folder):
    goal = EveryFrame(folder, pictures=12)
    for seq, number in enumerate((2, 0, 2, 3)):
        goal.take(played(number, seq))
    assert (goal.done, goal.total, goal.missing) == (3, 4, ["f1"])
    goal.take(played(1))
    assert goal.missing == []
    assert {name: scans["scan/fused"] for name, scans in goal.scans.items()} == {f"f{n}": n for n in range(4)}
    assert sorted(goal.frames) == ["f0", "f1", "f2", "f3"]


def test_of_many_frames_some_are_pictured_evenly_and_all_counted(folder):
    goal = EveryFrame(folder, pictures=2)
    for number in range(4):
        goal.take(played(number))
    assert sorted(goal.frames) == ["f0", "f3"]
    assert goal.done == 4


def test_bad_frames_are_left_out_and_told(folder):
    (folder / "f1.png").write_bytes((folder / "f1.png").read_bytes()[:60])
    Image.fromarray(np.zeros((5, 5), np.uint16)).save(folder / "f2.png")
    goal = EveryFrame(folder, pictures=12)
    assert goal.total == 2
    assert [why.split(":")[0] for why in goal.bad] == ["f1.png", "f2.png"]


def test_frames_of_equal_content_are_seen_together(folder):
    shutil.copy(folder / "f0.png", folder / "f9.png")
    goal = EveryFrame(folder, pictures=12)
    goal.take(played(0))
    assert goal.missing == ["f1", "f2", "f3"]
    assert (goal.done, goal.total) == (2, 5)


def test_a_frame_of_nobodys_is_ignored(folder):
    goal = EveryFrame(folder, pictures=12)
    goal.take(Frame(DepthImage.pack(0, 0, "optical", DEPTHS[0] + np.uint16(1), CAMERA, RAW), {}))
    assert goal.done == 0


def test_the_rate_is_within_limits(folder):
    assert EveryFrame(folder, pictures=1).rate == SLOWEST <= FASTEST


def test_a_folder_without_a_usable_frame_is_refused(folder, tmp_path):
    for png in folder.glob("*.png"):
        png.write_bytes(b"")
    with pytest.raises(ConfigError, match=r"no usable PNG in it; f0\.png: "):
        EveryFrame(folder, pictures=12)
    for png in folder.glob("*.png"):
        png.unlink()
    with pytest.raises(ConfigError, match="no PNG in it"):
        EveryFrame(folder, pictures=12)
    (folder / "camera.json").unlink()
    with pytest.raises(ConfigError, match=r"camera\.json: No such file"):
        EveryFrame(folder, pictures=12)
