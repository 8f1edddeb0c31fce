"""The Kinect source: the real libfreenect, fakenect playing a session, and a scripted library for what goes wrong."""

import logging
import threading
from collections.abc import Callable
from queue import Empty, Queue

import numpy as np
import pytest

from cliffscan.common.contract.camera import Camera
from cliffscan.services.capture.sources import device_thread, kinect, libfreenect
from cliffscan.services.capture.sources.depth_source import BadFrame, SourceLost
from cliffscan.services.capture.sources.kinect import Kinect
from tests.fakenect_session import (
    CAMERA,
    library_folder,
    open_camera_99,
    play,
    read_all,
    read_two,
    run,
    serve_all,
    write_session,
)
from tests.service.conftest import DEADLINE

needs_fakenect = pytest.mark.skipif(
    library_folder() is None, reason="needs Debian's package libfreenect0.5 (libfreenect and fakenect)"
)


def raw_frames(count):
    """Raw 11-bit frames in which every value occurs."""
    return np.random.default_rng(7).integers(0, 2048, (count, 480, 640), dtype=np.uint16)


@needs_fakenect
def test_every_frame_of_a_session_comes_through_unchanged(tmp_path):
    written = raw_frames(8)
    write_session(tmp_path, written, period=0.001)
    done = play(tmp_path, serve_all, str(tmp_path / "result.npy"))
    assert done.returncode == 0, done.stderr
    assert "Kinect 0 is gone (error -1)" in done.stderr  # the session's end looks like an unplugged device
    np.testing.assert_array_equal(np.load(tmp_path / "result.npy"), written)


@needs_fakenect
def test_frames_are_read_in_order_and_in_millimetres(tmp_path):
    written = raw_frames(8)
    write_session(tmp_path, written, period=0.05)
    done = play(tmp_path, read_all, str(tmp_path / "result.npz"))
    assert done.returncode == 0, done.stderr
    depth, stamp = (np.load(tmp_path / "result.npz")[name] for name in ("depth", "stamp"))
    expected = [kinect.disparity_table()[frame] for frame in written]
    came = [next(n for n in range(8) if np.array_equal(frame, expected[n])) for frame in depth]
    assert came == sorted(set(came))
    assert came[-1] == 7  # on a busy machine a frame may give way to the next, but never the newest one
    assert len(came) >= 2
    assert (np.diff(stamp) > 0).all()


@needs_fakenect
def test_closes_in_the_middle_of_a_stream(tmp_path):
    write_session(tmp_path, raw_frames(30), period=0.033)
    done = play(tmp_path, read_two)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@needs_fakenect
def test_without_a_session_fakenect_itself_ends_the_process(tmp_path):
    done = play(tmp_path, read_two)
    assert done.returncode == 1
    assert "Cannot open file" in done.stdout


@needs_fakenect
def test_with_the_real_library_a_camera_that_is_not_there_is_a_lost_source():
    done = run(open_camera_99)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(("no Kinect 99 (", "libfreenect finds no USB"))


def test_without_the_library_the_package_is_named(monkeypatch):
    monkeypatch.setattr(libfreenect, "NAMES", ("libfreenect-of-nowhere.so",))
    with pytest.raises(SourceLost, match=r"no library called libfreenect-of-nowhere\.so.* package libfreenect0\.5"):
        Kinect(CAMERA)


def test_the_disparity_table_ends_at_ten_metres():
    table = kinect.disparity_table()
    assert table[[0, 500, 1000, 1057]].tolist() == [305, 584, 3779, 9778]  # worked out from the formula
    assert (np.diff(table[:1058].astype(int)) >= 0).all()
    assert not table[1058:].any()
    assert len(table) == 2048


class ScriptedLibrary:
    """libfreenect with one device, which does what a test tells it: `turns` are its turns of the event loop."""

    def __init__(self) -> None:
        self.open_error = b""
        self.calls: list[str] = []
        self.turns: Queue[Callable[[], int]] = Queue()

    def __getattr__(self, name):
        return lambda *_: self.calls.append(name) or 0

    def freenect_set_log_callback(self, _context, callback):
        self.on_log = callback

    def freenect_set_depth_callback(self, _device, callback):
        self.on_depth = callback

    def freenect_num_devices(self, _context):
        return 1

    def freenect_open_device(self, _context, _device, _index):
        if not self.open_error:
            return 0
        self.on_log(None, libfreenect.LOG_ERROR, self.open_error)
        self.on_log(None, libfreenect.LOG_ERROR, b"Failed to open camera subdevice or it is not disabled.")
        return -1

    def freenect_find_depth_mode(self, resolution, depth_format):
        return libfreenect.FrameMode(0, resolution, depth_format, 640 * 480 * 2, 640, 480, 16, 0, 30, 1)

    def freenect_process_events_timeout(self, _context, _timeout):
        try:
            return self.turns.get(timeout=0.01)()
        except Empty:
            return 0

    def send(self, *frames) -> None:
        """Have frames delivered the way libfreenect does it: in one buffer, used again and again."""
        sent, buffer = threading.Event(), np.empty((480, 640), np.uint16)

        def turn() -> int:
            for frame in frames:
                buffer[:] = frame
                self.on_depth(None, buffer.ctypes.data, 0)
            buffer[:] = 0
            sent.set()
            return 0

        self.turns.put(turn)
        assert sent.wait(DEADLINE)


@pytest.fixture
def library(monkeypatch):
    scripted = ScriptedLibrary()
    monkeypatch.setattr(libfreenect, "load", lambda: scripted)
    return scripted


@pytest.fixture
def source(library):
    opened = Kinect(CAMERA)
    yield opened
    opened.close()


def test_the_newest_frame_wins_and_is_a_copy(library, source):
    library.send(1000, 2000, 3000)
    assert (source.read(timeout=DEADLINE).depth == 3000).all()
    assert source.read(timeout=0.0) is None


def test_a_frame_that_cannot_be_is_refused_and_the_next_one_read(library, source):
    library.send(10_001)
    with pytest.raises(BadFrame, match="holds 10001, expected at most 10000 in mode mm"):
        source.read(timeout=DEADLINE)
    library.send(10_000)
    assert source.read(timeout=DEADLINE).camera is CAMERA


def test_a_frame_of_another_size_is_refused(library):
    source = Kinect(Camera(320, 240, CAMERA.intrinsics, CAMERA.range, CAMERA.floor))
    library.send(1000)
    with pytest.raises(BadFrame, match=r"\(480, 640\).* \(240, 320\)"):
        source.read(timeout=DEADLINE)
    source.close()


def test_a_device_that_goes_is_released_in_order(library, source):
    library.turns.put(lambda: libfreenect.LIBUSB_ERROR_INTERRUPTED)  # a signal, which is no reason to give up
    library.send(1000)
    library.turns.put(lambda: -1)
    assert source.read(timeout=DEADLINE) is not None
    with pytest.raises(SourceLost, match=r"Kinect 0 is gone \(error -1\)"):
        source.read(timeout=DEADLINE)
    assert library.calls[-3:] == ["freenect_stop_depth", "freenect_close_device", "freenect_shutdown"]


def test_a_silent_device_is_lost(source, monkeypatch):
    monkeypatch.setattr(device_thread, "SILENCE", 0.05)
    with pytest.raises(SourceLost, match="Kinect 0 is silent"):
        source.read(timeout=DEADLINE)


def test_a_driver_that_hangs_holds_nobody_up(library):
    asked, answer = threading.Event(), threading.Event()
    source = Kinect(CAMERA)
    library.turns.put(lambda: asked.set() or answer.wait() - 1)
    assert asked.wait(DEADLINE)
    source.close()
    with pytest.raises(SourceLost, match="has not let go"):
        Kinect(CAMERA)
    answer.set()
    source.close()
    Kinect(CAMERA).close()


@pytest.mark.parametrize(
    ("error", "remedy"),
    [
        ("Could not open camera: -3", "join the group plugdev"),
        ("Failed to claim camera interface: LIBUSB_ERROR_BUSY", "another program has it"),
        ("Could not open camera: -4", "replug"),
    ],
)
def test_a_device_that_does_not_open_says_why(library, error, remedy):
    library.open_error = error.encode() + b"\n"
    with pytest.raises(SourceLost) as lost:
        Kinect(CAMERA)
    assert error in str(lost.value)
    assert remedy in str(lost.value)
    assert library.calls[-1] == "freenect_shutdown"


def test_what_the_library_says_is_logged_once(library, source, caplog):
    with caplog.at_level(logging.DEBUG, logger="kinect"):
        for _ in range(3):
            library.on_log(None, libfreenect.LOG_WARNING, b"Isochronous transfer error: 1\n")
    assert [(r.levelno, r.message) for r in caplog.records] == [(logging.WARNING, "Isochronous transfer error: 1")]
