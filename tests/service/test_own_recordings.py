"""Recordings of every kind go through capture to a fused scan, and the commands judge and convert them."""

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from tests import scenes
from tests.own_recordings import START, record, stamp_of
from tests.service.conftest import intensities, ranges
from tests.service.test_command import ask

CAMERA = scenes.camera(160, 120, FloorPlane.from_mount(0.45))
DEPTHS = [scenes.depth(CAMERA, wall=3.0) + np.uint16(number) for number in range(2)]
KINDS = ["bag", "sqlite", "mcap of its project"]


def is_first(scan):
    """Whether a scan is of the first image, in whichever round."""
    return (scan["stamp"] - START) % (2 * (stamp_of(1) - START)) == 0


def test_recordings_of_every_kind_and_what_is_converted_become_the_same_fused_scans(client, start, tmp_path):
    paths = {}
    for kind in KINDS:
        (tmp_path / kind).mkdir()
        paths[kind] = record(tmp_path / kind, kind, DEPTHS, CAMERA.intrinsics, 0.45)
    converted = ask("convert", paths["bag"], tmp_path / "folder")
    assert converted.returncode == 0, converted.stderr
    paths["folder"] = tmp_path / "folder"
    robots = {kind: client.another() for kind in paths}
    start("perception", robots=[each.robot for each in robots.values()], wait=False)
    for robot in robots.values():
        robot.wait_alive("fuse")
    scans = {kind: robot.listen("scan/fused") for kind, robot in robots.items()}
    for kind, path in paths.items():
        words = [
            word for each in ("source=replay", f"path={path}", "floor=fixed") for word in ("--set", f"capture.{each}")
        ]
        start("capture", *words, robots=[robots[kind].robot], wait=False)
    first = {kind: ear.until(is_first) for kind, ear in scans.items()}
    for kind, scan in first.items():
        np.testing.assert_array_equal(ranges(scan), ranges(first["folder"]), err_msg=kind)
        np.testing.assert_array_equal(intensities(scan), intensities(first["folder"]), err_msg=kind)
    ahead = slice(310, 330)
    assert ranges(first["bag"])[ahead] == pytest.approx(np.full(20, 3.0), abs=0.05)
    assert set(intensities(first["bag"])[ahead]) == {1}


def test_a_recording_is_judged_by_the_exit_code(tmp_path):
    path = record(tmp_path, "bag", DEPTHS, CAMERA.intrinsics, 0)
    bad = ask("check-data", path, "--set", "capture.height=0.8")
    assert bad.returncode == 1
    assert "wrong: the floor is seen in 0 of 2 frames" in bad.stdout


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["check-data", "nowhere"], "cliffscan: nowhere: no such file or folder\n"),
        (["convert", ".", "new", "--every", "0"], "0, expected 1 or more"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_exit_2(words, why):
    done = ask(*words)
    assert done.returncode == 2
    assert why in done.stderr
    assert "Traceback" not in done.stderr
