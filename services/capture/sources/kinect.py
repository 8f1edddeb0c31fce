"""The first Kinect (for Xbox 360, or for Windows v1) through libfreenect.

A call of libfreenect may take for ever: its control transfers have no timeout, and a stream stops only when USB
has handed every buffer back. And USB has to be served without a pause: the buffers in flight hold 32 ms.
So its calls are made by a DeviceThread.
"""

import ctypes
import logging
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources import libfreenect
from cliffscan.services.capture.sources.depth_source import BadFrame, DepthFrame, SourceLost
from cliffscan.services.capture.sources.device_thread import TURN, DeviceThread

Pixels: TypeAlias = NDArray[np.uint16]
Picture: TypeAlias = tuple[Pixels, int]  # and its stamp [ns]
Mode = Literal["mm", "11bit"]

FORMATS: dict[Mode, int] = {"mm": libfreenect.DEPTH_MM, "11bit": libfreenect.DEPTH_11BIT}
PERIOD = 1 / 30  # [s] from one frame to the next
FARTHEST = 10_000  # [mm] where libfreenect's millimetres end
NO_DISPARITY = 2047  # raw value of a pixel that saw no pattern
LARGEST: dict[Mode, int] = {"mm": FARTHEST, "11bit": NO_DISPARITY}

REPLUG = "replug its USB and its power"

LEVELS = {
    libfreenect.LOG_FATAL: logging.CRITICAL,
    libfreenect.LOG_ERROR: logging.ERROR,
    libfreenect.LOG_WARNING: logging.WARNING,
    libfreenect.LOG_NOTICE: logging.INFO,
    libfreenect.LOG_INFO: logging.DEBUG,
}
log = logging.getLogger("kinect")


class Kinect:
    """The depth stream of one Kinect.

    mode "mm" is calibrated in the factory; "11bit" takes the sensor's raw disparity through one table for all devices.
    A frame's stamp is the host's clock when its last packet had come in: it is late by the sensor's own work and by
    the transfer, which takes nearly a frame period (33 ms).
    Raises SourceLost when the device cannot be opened, as DeviceThread does.
    """

    def __init__(self, camera: Camera, mode: Mode = "mm", index: int = 0) -> None:
        self._camera, self._mode = camera, mode
        self._device = DeviceThread[Picture](f"Kinect {index}", REPLUG, partial(DepthStream, mode, index))

    def read(self, timeout: float) -> DepthFrame | None:
        """The newest frame not yet read, or None if none came within `timeout` [s].

        Raises BadFrame when a frame does not fit the camera or holds impossible values, SourceLost when the device
        is gone or silent.
        """
        picture = self._device.read(timeout)
        return self._frame(picture) if picture else None

    def close(self) -> None:
        """Release the device."""
        self._device.close()

    def _frame(self, picture: Picture) -> DepthFrame:
        pixels, stamp = picture
        expected = (self._camera.height, self._camera.width)
        if pixels.shape != expected:
            raise BadFrame(f"the Kinect's frame has {pixels.shape} (rows, columns), the camera is set to {expected}")
        return DepthFrame(millimetres(pixels, self._mode), stamp, self._camera, PERIOD)


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

    def __init__(self, mode: Mode, index: int, arrived: Callable[[Picture], None]) -> None:
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
        turn = libfreenect.Timeval(0, round(TURN * 1e6))
        result = self._library.freenect_process_events_timeout(self._context, ctypes.byref(turn))
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
            raise SourceLost(f"Kinect {self._index} does not start ({self._reason}): {REPLUG}")
        release.callback(self._library.freenect_stop_depth, self._device)

    def _copy_frame(self, _device: int, pixels: int, _ticks: int) -> None:
        stamp = time.time_ns()
        rows, columns = self._layout.height, self._layout.width
        buffer = (ctypes.c_uint16 * (rows * columns)).from_address(pixels)
        self._arrived((np.array(buffer).reshape(rows, columns), stamp))

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
    return REPLUG
