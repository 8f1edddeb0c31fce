"""Frames go out with the floor that is seen in them, and the service says where none is."""

from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane
from cliffscan.services.capture.__main__ import located
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import DepthFrame
from tests import build, scenes

TRUE = FloorPlane.from_mount(0.30)
CAMERA = scenes.camera(320, 240, TRUE, (0.5, 4.5))
FLOOR = scenes.depth(CAMERA, wall=20.0)
NOTHING = np.zeros_like(FLOOR)


def frame(depth, nominal):
    return DepthFrame(depth, 1, replace(CAMERA, floor=nominal))


def floors(service, *frames):
    return [each.camera.floor for each in located(iter(frames), service)]


@pytest.fixture
def service():
    return build.service("capture", CaptureConfig())


def test_the_floor_is_measured_around_the_frames_own(service):
    (found,) = floors(service, frame(FLOOR, FloorPlane.from_mount(0.33, 0.05, -0.03)))
    assert found == pytest.approx(TRUE, abs=1e-3)
    assert service.note == ""


def test_a_frame_without_floor_keeps_the_last_and_is_told_and_counted(service):
    nominal = FloorPlane.from_mount(0.32)
    seen, kept = floors(service, frame(FLOOR, nominal), frame(NOTHING, nominal))
    assert kept == seen
    assert "floor not seen" in service.note
    assert service.metrics.counts()["floor_kept"] == 1
    floors(service, frame(FLOOR, nominal))
    assert service.note == ""


def test_a_frame_of_another_mount_starts_anew(service):
    first, second = FloorPlane.from_mount(0.30), FloorPlane.from_mount(0.60, 0.4)
    assert floors(service, frame(FLOOR, first), frame(NOTHING, second))[1] == second


def test_a_fixed_floor_is_left_alone():
    service = build.service("capture", CaptureConfig(floor="fixed"))
    nominal = FloorPlane.from_mount(0.33, 0.05, -0.03)
    assert floors(service, frame(FLOOR, nominal), frame(NOTHING, nominal)) == [nominal, nominal]
    assert service.note == ""
