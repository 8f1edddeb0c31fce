"""The first Kinect (for Xbox 360, or for Windows v1) through libfreenect.

A call of libfreenect may take for ever: its control transfers have no timeout, and a stream stops only when USB
has handed every buffer back. And USB has to be served without a pause: the buffers in flight hold 32 ms.
So one thread makes every call, and nobody waits for that thread without a limit.
"""

import ctypes
import logging
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources import libfreenect
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame, SourceLost

Pixels = NDArray[np.uint16]
Mode = Literal["mm", "11bit"]

FORMATS: dict[Mode, int] = {"mm": libfreenect.DEPTH_MM, "11bit": libfreenect.DEPTH_11BIT}
PERIOD = 1 / 30  # [s] from one frame to the next
FARTHEST = 10_000  # [mm] where libfreenect's millimetres end
NO_DISPARITY = 2047  # raw value of a pixel that saw no pattern
LARGEST: dict[Mode, int] = {"mm": FARTHEST, "11bit": NO_DISPARITY}

PATIENCE = 0.5  # [s] longest wait for the driver's thread, when opening and when closing
SILENCE = 3.0  # [s] without a frame until the device counts as lost
TURN = libfreenect.Timeval(0, 100_000)  # longest turn of the event loop, so how soon the thread sees that it shall end

LEVELS = {
    libfreenect.LOG_FATAL: logging.CRITICAL,
    libfreenect.LOG_ERROR: logging.ERROR,
    libfreenect.LOG_WARNING: logging.WARNING,
    libfreenect.LOG_NOTICE: logging.INFO,
    libfreenect.LOG_INFO: logging.DEBUG,
}
log = logging.getLogger("kinect")


class Kinect:
    """The depth stream of one Kinect, a queue of one: a frame that nobody has read gives way to the next.

    mode "mm" is calibrated in the factory; "11bit" takes the sensor's raw disparity through one table for all devices.
    A frame's stamp is the host's clock when its last packet had come in: it is late by the sensor's own work and by
    the transfer, which takes nearly a frame period (33 ms).

    Raises SourceLost when the device cannot be opened. One that takes longer than PATIENCE is still opening when the
    constructor returns; read() then reports how it went.
    """

    def __init__(self, camera: Camera, mode: Mode = "mm", index: int = 0) -> None:
        self._camera, self._mode, self._index = camera, mode, index
        self._changed = threading.Condition()  # guards the next four
        self._newest: tuple[Pixels, int] | None = None
        self._opened = False
        self._lost = ""
        self._received_at = time.monotonic()
        self._closing = threading.Event()
        name = f"Kinect {index}"
        if any(thread.name == name for thread in threading.enumerate()):
            raise SourceLost(f"this process has not let go of {name} yet: unplug it, or restart the service")
        self._driver = threading.Thread(target=self._drive, name=name, daemon=True)
        self._driver.start()
        with self._changed:
            self._changed.wait_for(lambda: self._opened or self._lost, PATIENCE)
        if self._lost:
            self.close()
            raise SourceLost(self._lost)

    def read(self, timeout: float) -> DepthFrame | None:
        """The newest frame not yet read, or None if none came within `timeout` [s].

        Raises BadFrame when a frame does not fit the camera or holds impossible values, SourceLost when the device
        is gone or has sent nothing for SILENCE.
        """
        with self._changed:
            patience = min(timeout, self._received_at + SILENCE - time.monotonic())
            self._changed.wait_for(lambda: self._newest or self._lost, patience)
            newest, self._newest = self._newest, None
            silence = time.monotonic() - self._received_at
        if newest:
            return self._frame(*newest)
        if self._lost:
            raise SourceLost(self._lost)
        if silence >= SILENCE:
            raise SourceLost(f"Kinect {self._index} is silent for {silence:.1f} s: replug its USB and its power")
        return None

    def close(self) -> None:
        """Release the device. A driver that does not let go of it within PATIENCE is left to itself."""
        self._closing.set()
        self._driver.join(PATIENCE)
        if self._driver.is_alive():
            log.warning("Kinect %d does not close; its thread is left to wait for it", self._index)

    def _frame(self, pixels: Pixels, stamp: int) -> DepthFrame:
        expected = (self._camera.height, self._camera.width)
        if pixels.shape != expected:
            raise BadFrame(f"the Kinect's frame has {pixels.shape} (rows, columns), the camera is set to {expected}")
        return DepthFrame(millimetres(pixels, self._mode), stamp, self._camera, PERIOD)

    def _drive(self) -> None:
        """The driver's thread: open the stream, serve it until close(), release it."""
        try:
            with closing(DepthStream(self._mode, self._index, self._arrived)) as stream:
                with self._changed:
                    self._opened, self._received_at = True, time.monotonic()
                    self._changed.notify_all()
                while not self._closing.is_set():
                    stream.serve()
        except SourceLost as lost:
            with self._changed:
                self._lost = str(lost)
                self._changed.notify_all()

    def _arrived(self, pixels: Pixels, stamp: int) -> None:
        with self._changed:
            self._newest, self._received_at = (pixels, stamp), time.monotonic()
            self._changed.notify_all()


def open_configured(config: CaptureConfig) -> Kinect:
    """The Kinect that is configured. Raises SourceLost."""
    return Kinect(config.kinect(), config.depth_mode, config.device)


def disparity_table() -> Pixels:
    """Depth [mm] of each of the 2048 raw values; 0 for NO_DISPARITY and for all that is not within FARTHEST.

    z = 0.1236 · tan(raw / 2842.5 + 1.1863) [m], OpenKinect's fit for an average device. It reaches infinity at
    raw 1093 and means nothing beyond.
    """
    raw = np.arange(NO_DISPARITY + 1)
    depth = 1000.0 * 0.1236 * np.tan(raw / 2842.5 + 1.1863)
    measured = (depth > 0) & (depth <= FARTHEST) & (raw != NO_DISPARITY)
    return np.where(measured, np.rint(depth), 0).astype(np.uint16)


DISPARITY_TABLE = disparity_table()


def millimetres(pixels: Pixels, mode: Mode) -> Pixels:
    """Depth [mm], 0 = no return, of a frame as libfreenect gave it. Raises BadFrame for a value outside the mode's."""
    largest = int(pixels.max())
    if largest > LARGEST[mode]:
        raise BadFrame(f"the Kinect's frame holds {largest}, expected at most {LARGEST[mode]} in mode {mode}")
    return DISPARITY_TABLE[pixels] if mode == "11bit" else pixels


class DepthStream:
    """libfreenect's calls in order: opened and started by the constructor, served, closed; all in one thread.

    arrived: called within serve() with each frame, a copy, and its stamp [ns].
    Raises SourceLost, naming the remedy, when the device cannot be opened or is gone.
    """

    def __init__(self, mode: Mode, index: int, arrived: Callable[[Pixels, int], None]) -> None:
        try:
            self._library = libfreenect.load()
        except OSError as error:
            raise SourceLost(f"{error}: install libfreenect, on Debian the package libfreenect0.5") from error
        self._index, self._arrived = index, arrived
        self._reason = self._last_line = ""
        self._context, self._device = ctypes.c_void_p(), ctypes.c_void_p()
        self._on_log = libfreenect.LogCallback(self._write_log)  # C keeps no reference to its callbacks:
        self._on_depth = libfreenect.DepthCallback(self._copy_frame)  # they live as long as this object
        with ExitStack() as release:
            self._open_library(release)
            self._open_device(release)
            self._start(FORMATS[mode], release)
            self._release = release.pop_all()

    def serve(self) -> None:
        """Handle what USB has for us, for at most TURN."""
        result = self._library.freenect_process_events_timeout(self._context, ctypes.byref(TURN))
        if result < 0 and result != libfreenect.LIBUSB_ERROR_INTERRUPTED:  # a signal is no fault of the device
            raise SourceLost(f"Kinect {self._index} is gone (error {result}): check its USB and its power")

    def close(self) -> None:
        """Stop the stream, close the device, shut the library down."""
        self._release.close()

    def _open_library(self, release: ExitStack) -> None:
        result = self._library.freenect_init(ctypes.byref(self._context), None)
        if result < 0:
            raise SourceLost(f"libfreenect finds no USB (error {result}): does this machine, or container, have one?")
        release.callback(self._library.freenect_shutdown, self._context)
        self._library.freenect_set_log_callback(self._context, self._on_log)
        self._library.freenect_set_log_level(self._context, libfreenect.LOG_INFO)
        self._library.freenect_select_subdevices(self._context, libfreenect.DEVICE_CAMERA)

    def _open_device(self, release: ExitStack) -> None:
        connected = self._library.freenect_num_devices(self._context)
        if connected <= self._index:
            raise SourceLost(f"no Kinect {self._index} ({max(connected, 0)} found): plug in its USB and its power")
        if self._library.freenect_open_device(self._context, ctypes.byref(self._device), self._index) < 0:
            raise SourceLost(f"Kinect {self._index} does not open ({self._reason}): {remedy(self._reason)}")
        release.callback(self._library.freenect_close_device, self._device)

    def _start(self, depth_format: int, release: ExitStack) -> None:
        self._layout = self._library.freenect_find_depth_mode(libfreenect.RESOLUTION_MEDIUM, depth_format)
        self._library.freenect_set_depth_mode(self._device, self._layout)
        self._library.freenect_set_depth_callback(self._device, self._on_depth)
        if self._library.freenect_start_depth(self._device) < 0:
            raise SourceLost(f"Kinect {self._index} does not start ({self._reason}): replug its USB and its power")
        release.callback(self._library.freenect_stop_depth, self._device)

    def _copy_frame(self, _device: int, pixels: int, _ticks: int) -> None:
        stamp = time.time_ns()
        rows, columns = self._layout.height, self._layout.width
        buffer = (ctypes.c_uint16 * (rows * columns)).from_address(pixels)
        self._arrived(np.array(buffer).reshape(rows, columns), stamp)

    def _write_log(self, _context: int, level: int, message: bytes) -> None:
        """Pass a line on, but not one that repeats the one before: a bad cable yields hundreds a second."""
        line = message.decode(errors="replace").strip()
        if level <= libfreenect.LOG_ERROR:
            self._reason = self._reason or line  # the first error is the cause; libfreenect reports it nowhere else
        if line != self._last_line:
            log.log(LEVELS.get(level, logging.DEBUG), "%s", line)
        self._last_line = line


def remedy(reason: str) -> str:
    """What to do about the error that kept a device from opening. -3 and -6 are libusb's ACCESS and BUSY."""
    if reason.endswith(("-3", "ACCESS")):
        return "install the udev rules of libfreenect0.5, join the group plugdev, and replug it"
    if reason.endswith(("-6", "BUSY")):
        return "another program has it"
    return "replug its USB and its power"
