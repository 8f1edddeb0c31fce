"""OpenNI2 cameras: OpenNI2 itself, reading its Dummy device, whose first row lies 2 m ahead."""

import ctypes
import math
import time

import numpy as np
import pytest

from cliffscan.common.contract.camera import KINECT_BASELINE, KINECT_NOISE, check_camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import KINECT_RANGE, CaptureConfig
from cliffscan.services.capture.sources import libopenni2
from cliffscan.services.capture.sources.depth_source import SourceLost
from cliffscan.services.capture.sources.open_source import open_source
from tests.openni2_library import Library, needs_openni2

DEADLINE = 60.0  # [s]


@pytest.fixture
def opened():
    """Open the source with settings."""
    sources = []

    def begin(serial="Dummy", **settings):
        sources.append(open_source(CaptureConfig(source="openni2", serial=serial, **settings)))
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


@pytest.fixture(autouse=True)
def library(monkeypatch):
    """Use the real library, of which single functions may be others."""
    load = libopenni2.load

    def begin(**others):
        made = Library(load(), **others)
        monkeypatch.setattr(libopenni2, "load", lambda: made)
        return made

    monkeypatch.setattr(libopenni2, "load", lambda: Library(load()))
    return begin


@needs_openni2
def test_depths_come_in_millimetres_with_an_xtions_calibration_where_the_camera_tells_none(opened):
    before = time.time_ns()
    depth, stamp, camera, period, place = first_frame(opened(height=0.4))
    assert (depth.shape, depth.dtype, camera.width, camera.height) == ((240, 320), np.uint16, 320, 240)
    assert (depth[0] == 2000).all()
    assert before < stamp < time.time_ns()
    assert camera.intrinsics == pytest.approx((287.9, 287.9, 159.5, 119.5), abs=0.1)
    assert (camera.range, camera.noise, camera.baseline) == (KINECT_RANGE, KINECT_NOISE, KINECT_BASELINE)
    assert camera.floor.d == 0.4
    assert (period, place) == (1 / 30, None)
    check_camera(camera)


@needs_openni2
def test_frames_follow_one_another_and_are_copies(opened):
    source = opened()
    first, second = first_frame(source), first_frame(source)
    assert first.stamp < second.stamp
    assert not np.array_equal(first.depth, second.depth)


@needs_openni2
def test_a_camera_that_tells_its_field_of_view_and_baseline_is_taken_at_its_word(opened, library):
    told = {
        libopenni2.STREAM_HORIZONTAL_FOV: (ctypes.c_float, math.pi / 2),
        libopenni2.STREAM_VERTICAL_FOV: (ctypes.c_float, math.pi / 3),
        libopenni2.STREAM_EMITTER_DISTANCE: (ctypes.c_double, 15.0),
    }

    def get(stream, number, value, size):
        if number not in told:
            return real(stream, number, value, size)
        kind, number_told = told[number]
        ctypes.cast(value, ctypes.POINTER(kind))[0] = number_told
        return libopenni2.OK

    real = libopenni2.load().oniStreamGetProperty
    library(oniStreamGetProperty=get)
    camera = first_frame(opened()).camera
    assert camera.intrinsics == pytest.approx((160.0, 120 * math.sqrt(3), 159.5, 119.5))
    assert (camera.baseline, camera.noise) == pytest.approx((0.15, KINECT_NOISE / 2))


@needs_openni2
def test_a_camera_that_mirrors_is_told_not_to(opened, library):
    was_set = {}

    def put(_stream, number, value, size):
        was_set[number] = ctypes.string_at(value, size)
        return libopenni2.OK

    library(oniStreamIsPropertySupported=lambda _stream, number: number == libopenni2.STREAM_MIRRORING,
            oniStreamSetProperty=put)  # fmt: skip
    first_frame(opened())
    assert was_set[libopenni2.STREAM_MIRRORING] == bytes(4)


@needs_openni2
def test_a_camera_that_cannot_be_kept_from_mirroring_is_not_used(opened, library):
    library(
        oniStreamIsPropertySupported=lambda *_: 1,
        oniStreamSetProperty=lambda _stream, number, *_: int(number == libopenni2.STREAM_MIRRORING),
    )
    with pytest.raises(SourceLost, match="OpenNI2 camera Dummy refuses its mirroring"):
        read_until_lost(opened())


@needs_openni2
def test_tenths_of_millimetres_become_millimetres(opened, monkeypatch):
    monkeypatch.setitem(libopenni2.UNITS, 100, 0.1)
    assert (first_frame(opened()).depth[0] == 200).all()


@needs_openni2
def test_a_camera_that_is_not_there_is_lost_with_the_remedy(opened):
    with pytest.raises(SourceLost, match=r"no OpenNI2 camera 1234 \(\d found.*\): plug in its USB; .*group video"):
        read_until_lost(opened(serial="1234"))


@needs_openni2
def test_a_recording_is_no_camera(opened, library):
    library(oniDeviceIsPropertySupported=lambda *_: 1)
    with pytest.raises(ConfigError, match=r"capture\.serial: OpenNI2 camera Dummy is a recording"):
        read_until_lost(opened())


@needs_openni2
def test_a_camera_that_goes_is_released_in_order_and_read_again(opened, library, monkeypatch):
    real = libopenni2.load().oniWaitForAnyStream
    gone = False
    watched = library(oniWaitForAnyStream=lambda *call: 1 if gone else real(*call))
    source = opened()
    first_frame(source)
    gone = True
    with pytest.raises(SourceLost, match=r"OpenNI2 camera Dummy is gone \(.*\): replug its USB"):
        read_until_lost(source)
    source.close()
    assert watched.calls[-3:] == ["oniStreamStop", "oniStreamDestroy", "oniDeviceClose"]
    gone = False
    first_frame(opened())


@needs_openni2
def test_a_size_that_the_camera_lacks_is_refused_with_those_it_has(opened):
    with pytest.raises(ConfigError, match=r"capture\.size: .* no depth of \[640, 480\]; choose one of \[320, 240\]"):
        read_until_lost(opened(size=(640, 480)))


def test_without_the_library_the_package_is_named(opened, monkeypatch):
    monkeypatch.setattr(libopenni2, "NAMES", ("libOpenNI-of-nowhere.so",))
    with pytest.raises(SourceLost, match=r"no library called libOpenNI-of-nowhere\.so.* package libopenni2-0"):
        read_until_lost(opened())
