"""RealSense cameras: librealsense itself, reading its own software device."""

import math
import sys
import time

import numpy as np
import pytest

from cliffscan.common.contract.camera import check_camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources import device_thread, realsense_sensor
from cliffscan.services.capture.sources.depth_source import SourceLost
from cliffscan.services.capture.sources.open_source import open_source

rs = pytest.importorskip(
    "pyrealsense2", reason="needs the extra realsense and Debian's package libusb-1.0-0", exc_type=ImportError
)
from cliffscan.services.capture.sources import realsense  # noqa: E402 below the check that it can be loaded
from tests.realsense_camera import BASELINE, INTRINSICS, SCENE, SIZE, SoftwareCamera  # noqa: E402

DEADLINE = 60.0  # [s]


@pytest.fixture
def plug(monkeypatch):
    """Plug in cameras, the only ones that there are."""
    cameras = []
    monkeypatch.setattr(realsense, "connected", lambda: [each for each in cameras if each.is_connected()])

    def begin(**told):
        cameras.append(SoftwareCamera(**told))
        return cameras[-1]

    yield begin
    for camera in cameras:
        camera.close()


@pytest.fixture
def opened():
    """Open the source with settings."""
    sources = []

    def begin(**settings):
        sources.append(open_source(CaptureConfig(source="realsense", **settings)))
        return sources[-1]

    yield begin
    for source in sources:
        source.close()


def first_frame(source):
    """The first frame that comes."""
    deadline = time.monotonic() + DEADLINE
    while time.monotonic() < deadline:
        if frame := source.read(0.1):
            return frame
    raise AssertionError("no frame")


def read_until_lost(source):
    """Read until the source raises, as one does whose camera took its time to open."""
    deadline = time.monotonic() + DEADLINE
    while time.monotonic() < deadline:
        source.read(0.1)


@pytest.mark.parametrize("unit", [1e-3, 1e-4])
def test_depths_come_in_millimetres_with_the_cameras_own_calibration(plug, opened, unit):
    plug(unit=unit)
    depth, _, camera, period, place = first_frame(opened(height=0.4))
    assert depth.dtype == np.uint16
    np.testing.assert_array_equal(depth > 0, SCENE > 0)
    assert np.abs(depth.astype(int) - SCENE).max() <= 1
    assert (camera.width, camera.height) == SIZE
    assert camera.intrinsics == pytest.approx(INTRINSICS)
    assert camera.floor.d == 0.4
    assert (period, place) == (1 / 30, None)
    check_camera(camera)


def test_noise_baseline_and_range_follow_from_the_cameras_two_eyes(plug, opened):
    plug()
    camera = first_frame(opened()).camera
    assert camera.baseline == pytest.approx(BASELINE)
    disparity = INTRINSICS.fx * BASELINE / np.array(camera.range)  # [px] nearest and farthest
    assert disparity[0] == pytest.approx(126)
    assert camera.noise * INTRINSICS.fx * BASELINE == pytest.approx(0.1)
    assert camera.noise * camera.range[1] ** 2 == pytest.approx(0.2)


def test_a_camera_with_one_eye_has_the_documented_values(plug, opened):
    plug(baseline=0)
    camera = first_frame(opened()).camera
    assert (camera.range, camera.noise, camera.baseline) == realsense_sensor.ONE_EYE


def test_a_frame_has_the_stamp_of_its_exposure(plug, opened):
    camera = plug()
    stamp = first_frame(opened()).stamp
    assert min(abs(stamp - 1e6 * each) for each in camera.stamps) < 1000


def test_a_stamp_of_the_cameras_own_clock_is_replaced_by_the_hosts(plug, opened):
    camera = plug()
    camera.domain = rs.timestamp_domain.hardware_clock
    before = time.time_ns()
    stamp = first_frame(opened()).stamp
    assert before < stamp < time.time_ns()
    assert stamp not in [round(1e6 * each) for each in camera.stamps]


def test_the_camera_with_the_serial_number_is_taken(plug, opened):
    plug(serial="111", baseline=0.05)
    plug(serial="222", baseline=0.07)
    assert first_frame(opened(serial="222")).camera.baseline == pytest.approx(0.07)
    with pytest.raises(SourceLost, match=r"no RealSense 333 \(found: 111, 222\): plug it .* udev/60-realsense\.rules"):
        read_until_lost(opened(serial="333"))


def test_librealsense_itself_finds_no_camera_and_the_line_has_the_remedy(opened):
    with pytest.raises(SourceLost, match=r"no RealSense no such number \(found: .*plug it into a USB 3"):
        read_until_lost(opened(serial="no such number"))


def test_a_camera_that_goes_is_lost_and_one_that_comes_back_is_read_again(plug, opened):
    camera = plug()
    source = opened()
    first_frame(source)
    camera.unplug()
    with pytest.raises(SourceLost, match="RealSense is gone: replug it into a USB 3 port"):
        read_until_lost(source)
    source.close()
    with pytest.raises(SourceLost, match="no RealSense"):
        read_until_lost(opened())
    plug()
    first_frame(opened())


def test_a_silent_camera_is_lost(plug, opened, monkeypatch):
    camera = plug()
    source = opened()
    first_frame(source)
    monkeypatch.setattr(device_thread, "SILENCE", 0.05)
    camera.close()
    with pytest.raises(SourceLost, match="RealSense is silent for"):
        read_until_lost(source)


def test_a_size_that_the_camera_lacks_is_refused_with_those_it_has(plug, opened):
    plug(sizes=(SIZE, (160, 120)))
    with pytest.raises(ConfigError, match=r"capture\.size: .* no depth of \[640, 480\].*\[160, 120\], \[320, 240\]"):
        read_until_lost(opened(size=(640, 480)))


def test_a_distorted_image_is_refused(plug, opened):
    plug(coefficients=(0.1, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(ConfigError, match=r"distorted depth image.*capture\.source=ros2"):
        read_until_lost(opened())


def test_what_millimetres_cannot_express_is_no_return():
    pixels = np.array([[0, 1, 6553, 6554, 65535]], np.uint16)
    assert realsense_sensor.millimetres(pixels, 0.01).tolist() == [[0, 10, 65530, 0, 0]]


@pytest.mark.parametrize(
    ("reason", "remedy"),
    [
        ("failed to open usb interface: 0, error: RS2_USB_STATUS_ACCESS", "udev/60-realsense.rules"),
        ("Cannot open '/dev/video2': Permission denied", "udev/60-realsense.rules"),
        ("xioctl(VIDIOC_S_FMT) failed, errno=16 Last Error: Device or resource busy", "another program has it"),
        ("failed to set power state", "replug"),
    ],
)
def test_what_librealsense_says_becomes_a_remedy(monkeypatch, opened, reason, remedy):
    class Refusing:
        def get_info(self, _what):
            return "1"

        def first_depth_sensor(self):
            raise RuntimeError(reason)

    monkeypatch.setattr(realsense, "connected", lambda: [Refusing()])
    with pytest.raises(SourceLost) as lost:
        read_until_lost(opened())
    assert reason in str(lost.value)
    assert remedy in str(lost.value)


def test_without_its_system_library_the_package_is_named(monkeypatch):
    class Broken:
        def find_spec(self, name, *_):
            if name == "pyrealsense2":
                raise ImportError("libusb-1.0.so.0: cannot open shared object file: No such file or directory")

    for name in ("pyrealsense2", realsense.__name__):
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [Broken(), *sys.meta_path])
    with pytest.raises(ConfigError, match=r"libusb-1\.0\.so\.0: cannot open.*apt install libusb-1\.0-0"):
        open_source(CaptureConfig(source="realsense"))


def test_any_stereo_camera_is_a_possible_one():
    for focal in (100.0, 430.0, 1300.0):
        for baseline in (0.018, 0.05, 0.095):
            (near, far), noise, _ = realsense_sensor.stereo(focal, baseline)
            assert 0 < near < far < math.inf
            assert noise == pytest.approx(0.1 / (focal * baseline), abs=0.05)
