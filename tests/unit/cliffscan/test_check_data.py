"""A recording is described, measured and judged: what a robot would suffer from is told with its remedy, exit 1."""

import json
import re

import numpy as np
import pytest
from PIL import Image

from cliffscan.check_data import check_data
from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.capture.config import CaptureConfig
from tests import scenes
from tests.own_recordings import SECOND, TOPIC, break_chunk, record

CAMERA = scenes.camera(160, 120, FloorPlane.from_mount(0.45))
DICE = np.random.default_rng(4)
SCENE = scenes.depth(CAMERA, wall=5.0)
NOISE = 0.001  # [1/m]


def shots(count=3, scene=SCENE):
    """Pictures of one place with a sensor's noise."""
    inverse = [1.0 / np.maximum(scene / 1e3, 0.1) + DICE.normal(0, NOISE, scene.shape) for _ in range(count)]
    return [np.where(scene > 0, 1e3 / each, 0).round().astype(np.uint16) for each in inverse]


def recorded(folder, kind="bag", depths=None, **options):
    return record(
        folder, kind, shots() if depths is None else depths, CAMERA.intrinsics, **({"height": 0.45} | options)
    )


@pytest.fixture
def check(capsys):
    """The exit code, and what is said: all, and what is wrong."""

    def ask(path, **settings):
        config = CaptureConfig(source="replay", path=str(path), **settings)
        code = check_data(path, config, StopSignal())
        said = capsys.readouterr().out
        wrong = [line.removeprefix("wrong: ") for line in said.splitlines() if line.startswith("wrong: ")]
        assert code == (1 if wrong else 0)
        return said, wrong

    return ask


@pytest.mark.parametrize("kind", ["bag", "sqlite", "mcap of its project"])
def test_a_good_recording_is_described(tmp_path, check, kind):
    said, wrong = check(recorded(tmp_path, kind))
    assert not wrong
    assert {"bag": "ROS 1 bag", "mcap file": "MCAP file", "mcap of its project": "MCAP file"}.get(
        kind, "ROS 2 bag"
    ) in said
    for line in (
        "3 depth images",
        f"contents: {TOPIC}: 3 sensor_msgs/msg/Image",
        "times: 0.20 s, 10.0 Hz, longest pause 0.10 s",
        "160x120",
        f"units: millimetres, for {TOPIC} is 16UC1",
        "intrinsics: fx 144.3, fy 144.3, cx 79.5, cy 59.5 px, by /camera/depth/camera_info",
        "range: 0.5 to 4.5 m, by capture.range",
        "mount: 0.450 m high, 0.0 deg down, rolled 0.0 deg, by /tf_static of 'eye'",
        "place on the base: x 0.100 m, y 0.000 m, yaw 0.0 deg",
        "noise: 0.00165 1/m, a Kinect's",
        "region: all pixels",
        "measured floor: seen in 3 of 3 frames, 0.45",
        "nothing is wrong",
    ):
        assert line in said


def test_a_depth_folder_is_described(tmp_path, check):
    for number, depth in enumerate(shots()):
        Image.fromarray(depth).save(tmp_path / f"{number}.png")
    told = {"width": 160, "height": 120, "intrinsics": CAMERA.intrinsics, "range": (0.4, 6.0), "floor": CAMERA.floor}
    (tmp_path / "camera.json").write_text(json.dumps(told | {"noise": NOISE, "region": (0, 0, 159, 118)}))
    said, wrong = check(tmp_path)
    assert not wrong
    for line in (
        "depth folder, 3 depth images",
        "no stamps",
        "range: 0.4 to 6 m, by camera.json",
        "0.450 m high, 0.0 deg down, rolled 0.0 deg, by camera.json",
        "noise: 0.00100 1/m, by camera.json",
        "region: [0, 0, 159, 118], as given",
        "seen in 3 of 3 frames",
    ):
        assert line in said
    assert measured(said) == pytest.approx(NOISE, rel=0.3)


def measured(said):
    return float(said.partition("measured noise: ")[2].split()[0])


def test_a_mount_that_is_a_little_wrong_is_told_with_the_right_one(tmp_path, check):
    said, wrong = check(recorded(tmp_path, height=0), height=0.41, pitch=3.0)
    assert "as configured, for no static transform leads from base_footprint or base_link to 'eye'" in said
    assert len(wrong) == 1
    assert "the mount is wrong by 4" in wrong[0]
    assert "give 0.45" in wrong[0]
    assert "capture.height" in wrong[0]


@pytest.mark.parametrize(
    ("options", "settings", "why"),
    [
        ({"depths": [np.zeros((120, 160), np.uint16)] * 2}, {}, "0.0% of the pixels return something: uncover"),
        ({"depths": [each * 4 for each in shots()]}, {}, "make a floor if their unit is 0.25 mm: write them in milli"),
        ({"height": 0.9}, {}, "the floor is seen in 0 of 3 frames near its mount: .* give the mount within 5 deg"),
        ({"depths": [SCENE] * 3}, {}, "2 frames repeat the one before bit for bit, .* restart its driver"),
        ({}, {"range": (0.1, 1.0)}, "% of the returns lie within 0.1 to 1 m: set the sensor's range"),
        ({"damaged": [1]}, {}, "1 of 3 images are lost to a robot; 000001: .*: it was damaged after it was recorded"),
    ],
)
def test_what_a_robot_would_suffer_from_is_told_with_a_remedy(tmp_path, check, options, settings, why):
    _, wrong = check(recorded(tmp_path, **options), **settings)
    assert any(re.search(why, line) for line in wrong), wrong


def test_a_file_that_ends_early_has_lost_all_that_it_promised(tmp_path, check):
    path = recorded(tmp_path, "mcap of its project", shots(4))
    break_chunk(path, -6)  # of the second image
    _, wrong = check(path)
    assert re.match(r"3 of 4 images are lost to a robot; 000001: the rest of drive.mcap cannot be read", wrong[0])


def test_intrinsics_of_another_image_are_told(tmp_path, check):
    fx, fy, cx, cy = CAMERA.intrinsics
    path = record(tmp_path, "bag", shots(), (fx, 0.8 * fy, 2 * cx, cy), 0.45)
    _, wrong = check(path)
    assert any("principal point (159, 60) is far from the middle of 160x120" in line for line in wrong)
    assert any("focal lengths 144 and 115 px differ" in line for line in wrong)


def test_what_cannot_be_opened_is_one_line(tmp_path, check):
    (tmp_path / "drive.mcap").write_bytes(b"nothing")
    said, wrong = check(tmp_path / "drive.mcap")
    assert len(said.splitlines()) == 1
    assert "give a ROS bag, an MCAP file or a depth folder" in wrong[0]


def test_a_noisy_floor_and_a_pause_are_noted_and_not_wrong(tmp_path, check):
    frames = {f"{n}": {"stamp": stamp} for n, stamp in enumerate((1, 2, 3, 14))}
    for number, depth in enumerate(shots(4)):
        Image.fromarray(depth).save(tmp_path / f"{number}.png")
    frames = {name: {"stamp": each["stamp"] * SECOND // 10} for name, each in frames.items()}
    told = {"width": 160, "height": 120, "intrinsics": CAMERA.intrinsics, "range": (0.4, 6.0), "floor": CAMERA.floor}
    (tmp_path / "camera.json").write_text(json.dumps(told | {"noise": NOISE / 4, "frames": frames}))
    said, wrong = check(tmp_path)
    assert not wrong
    assert "note: no frame for 1.1 s" in said
    assert "times as far off the floor's plane as the noise assumed" in said
