"""Frames go out with the floor that is seen in them, and the service says where none is."""

from dataclasses import replace

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, Region
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.__main__ import Bounds, bounded, located
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
    (found,) = floors(service, frame(FLOOR, FloorPlane.from_mount(0.32, 0.05, -0.03)))
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


def cameras(config, *frames):
    service = build.service("capture", config)
    return [each.camera for each in bounded(iter(frames), service, Bounds())]


def test_what_is_configured_of_the_sensor_goes_out_with_each_frame():
    config = CaptureConfig(range=[0.3, 6.0], noise=0.004, baseline=0.05, region=[1, 2, 300, 200])
    (camera,) = cameras(config, frame(FLOOR, TRUE))
    assert camera == replace(CAMERA, range=(0.3, 6.0), noise=0.004, baseline=0.05, seen=Region(1, 2, 300, 200))


def test_what_is_not_configured_of_the_sensor_is_what_its_source_says():
    own = replace(CAMERA, range=(0.2, 9.0), noise=0.002, baseline=0.0, seen=Region(0, 0, 319, 230))
    assert cameras(CaptureConfig(), DepthFrame(FLOOR, 1, own)) == [own]


def test_a_region_outside_the_image_is_refused_with_one_line():
    with pytest.raises(ConfigError, match=r"^capture\.region: .* of an image of 320x240$"):
        cameras(CaptureConfig(region=[0, 0, 639, 470]), frame(FLOOR, TRUE))
    with pytest.raises(ValueError, match="expected none or 4"):
        CaptureConfig(region=[0, 0, 319])


def test_a_border_that_is_learnt_is_noted_logged_once_and_sent(service, caplog):
    caplog.set_level("INFO")
    bounds = Bounds()
    pictures = [np.where(np.arange(240)[:, None] < 230, FLOOR, 0).astype(np.uint16)]
    pictures += [np.where(pictures[0] > 0, 700 * n, 0).astype(np.uint16) for n in (1, 2, 3)]
    seen = bounded((frame(each, TRUE) for each in (*pictures, *pictures)), service, bounds)
    found = [each.camera.seen for each in located(seen, service, lambda: bounds.note)]
    assert found[-1] == Region(0, found[-1].first_row, 319, 229)
    assert found[0] is None
    told = f"capture.region = {list(found[-1])}"
    assert told in service.note
    assert sum(told in each.message for each in caplog.records) == 1
    beyond = bounded(iter([frame(np.full_like(FLOOR, 800), TRUE)]), service, bounds)
    assert [each.camera.seen for each in beyond] == [None]
    assert bounds.note == ""
