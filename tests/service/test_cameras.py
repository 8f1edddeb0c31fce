"""RealSense and OpenNI2 cameras go through capture to a fused scan, each by its real library."""

import importlib
import math
import sys

import numpy as np
import pytest

from cliffscan.services.capture.sources.openni2 import FIELD_OF_VIEW
from tests.openni2_library import needs_openni2
from tests.service.conftest import intensities, ranges

POSITIVE = 1  # evidence of an obstacle


@pytest.fixture
def camera(client, start, run):
    """Start perception, and capture in the process of `module` with settings."""

    def begin(module, *settings):
        start("perception")
        words = [word for each in settings for word in ("--set", f"capture.{each}")]
        command = [sys.executable, "-m", module, "--robot", client.robot, "--connect", client.endpoint, *words]
        return run(command)

    return begin


def angles(scan):
    return scan["angle_min"] + scan["angle_increment"] * np.arange(len(ranges(scan)))


def test_a_realsense_camera_becomes_a_fused_scan(client, camera):
    pytest.importorskip(
        "pyrealsense2", reason="needs the extra realsense and Debian's package libusb-1.0-0", exc_type=ImportError
    )
    known = importlib.import_module("tests.realsense_camera")
    scans, descriptions = client.listen("scan/fused"), client.listen("description")
    camera("tests.realsense_camera", "source=realsense", "serial=0123", "height=0.3")
    scan = scans.get()
    ahead = np.abs(angles(scan)) < 0.3
    wall = ranges(scan)[ahead] * np.cos(angles(scan)[ahead])
    assert wall == pytest.approx(np.full(len(wall), 2.0), abs=0.05)
    assert set(intensities(scan)[ahead]) == {POSITIVE}
    told = descriptions.get()["camera"]
    assert told["baseline"] == pytest.approx(known.BASELINE)
    assert not told["simulated"]


@needs_openni2
def test_an_openni2_camera_becomes_a_fused_scan(client, camera):
    """The Dummy device's first row lies 2 m ahead; looked at from half the field of view down, it is level."""
    down = FIELD_OF_VIEW[1] / 2 * (1 - 1 / 240)  # to the middle of the first row
    scans = client.listen("scan/fused")
    pitch = f"pitch={math.degrees(down):.4f}"
    camera("tests.openni2_library", "source=openni2", "serial=Dummy", "height=0.3", pitch, "floor=fixed")
    scan = scans.get()
    right = (angles(scan) < -0.1) & (angles(scan) > -0.4)
    wall = ranges(scan)[right] * np.cos(angles(scan)[right])
    assert wall == pytest.approx(np.full(len(wall), 2.0 / math.cos(down)), abs=0.02)
    assert set(intensities(scan)[right]) == {POSITIVE}
