"""Cameras that OpenNI2 reads: Asus Xtion, PrimeSense Carmine, and others whose maker has a driver for it.

OpenNI2 is called as libfreenect is, in one thread: opening a camera takes seconds, and one that hangs never returns.
It is never shut down, for it would unload a driver whose threads may still run. It follows by itself which cameras are
plugged in.
"""

import ctypes
import math
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import KINECT_BASELINE, KINECT_NOISE, Camera, Intrinsics
from cliffscan.common.contract.limits import WIDEST_BASELINE
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import KINECT_RANGE, CaptureConfig
from cliffscan.services.capture.sources import libopenni2
from cliffscan.services.capture.sources.depth_source import DepthFrame, SourceLost
from cliffscan.services.capture.sources.device_thread import TURN, DeviceThread
from cliffscan.services.capture.sources.libopenni2 import Handle
from cliffscan.services.capture.sources.modes import best_mode

FIELD_OF_VIEW = (1.0145, 0.7898)  # [rad] of an Xtion, across and upright, where a camera does not tell its own
REPLUG = "replug its USB"

Value = TypeVar("Value", ctypes.c_float, ctypes.c_double)


def open_configured(config: CaptureConfig) -> DeviceThread[DepthFrame]:
    """The camera with the configured serial number, or the first. Raises SourceLost, ConfigError."""
    name = f"OpenNI2 camera {config.serial}".rstrip()
    return DeviceThread(name, REPLUG, partial(OpenNI2Stream, name, config))


def noise(baseline: float) -> float:
    """Standard deviation [1/m] of the inverse depth by the baseline [m]: a Kinect's, for PrimeSense's chip is in it.

    The chip correlates the same pattern whatever size it sends.
    """
    return KINECT_NOISE * KINECT_BASELINE / baseline


class OpenNI2Stream:
    """OpenNI2's calls in order: opened and started by the constructor, served, closed; all in one thread.

    arrived: called within serve() with each frame. A frame's stamp is the host's clock when it had come in: it is late
    by the sensor's own work and by the transfer.
    Raises SourceLost, naming the remedy, when the camera cannot be opened or is gone; ConfigError for a size that it
    does not have.
    """

    def __init__(self, name: str, config: CaptureConfig, arrived: Callable[[DepthFrame], None]) -> None:
        self._name, self._arrived = name, arrived
        try:
            self._library = libopenni2.load()
        except OSError as error:
            raise SourceLost(f"{error}: install OpenNI2, on Debian the package libopenni2-0") from error
        with ExitStack() as release:
            self._check("has no driver", self._library.oniInitialize(libopenni2.API_VERSION))
            self._device = self._open_device(config.serial, release)
            self._stream = self._create_stream(release)
            mode = self._set_mode(config)
            self._period, self._unit = 1.0 / mode.fps, libopenni2.UNITS[mode.pixel_format]
            self._camera = self._describe(mode, config)
            self._check("does not start", self._library.oniStreamStart(self._stream))
            release.callback(self._library.oniStreamStop, self._stream)
            self._release = release.pop_all()

    def serve(self) -> None:
        """Wait for a frame, for at most TURN, and pass it on."""
        streams, ready = (Handle * 1)(self._stream), ctypes.c_int()
        result = self._library.oniWaitForAnyStream(streams, 1, ctypes.byref(ready), round(TURN * 1e3))
        if result == libopenni2.TIME_OUT:
            return
        self._check("is gone", result)
        frame = ctypes.POINTER(libopenni2.Frame)()
        self._check("is gone", self._library.oniStreamReadFrame(self._stream, ctypes.byref(frame)))
        stamp = time.time_ns()
        try:
            depth = self._millimetres(frame.contents)
        finally:
            self._library.oniFrameRelease(frame)
        self._arrived(DepthFrame(depth, stamp, self._camera, self._period))

    def close(self) -> None:
        """Stop the stream and close the camera."""
        self._release.close()

    def _check(self, what: str, status: int) -> None:
        if status != libopenni2.OK:
            raise SourceLost(f"{self._name} {what} ({self._reason()}): {REPLUG}")

    def _reason(self) -> str:
        told: bytes = self._library.oniGetExtendedError() or b""
        return " ".join(told.decode(errors="replace").split()) or "no reason given"

    def _open_device(self, wanted: str, release: ExitStack) -> Handle:
        """The first camera, or the one whose serial number or OpenNI2 address is `wanted`."""
        listed, refused = self._addresses(), ""
        for address in [*listed, *([wanted.encode()] if wanted else [])]:
            device = Handle()
            if self._library.oniDeviceOpen(address, ctypes.byref(device)) != libopenni2.OK:
                refused = refused or self._reason()
                continue
            if not wanted or wanted in (address.decode(), self._serial(device)):
                release.callback(self._library.oniDeviceClose, device)
                return device
            self._library.oniDeviceClose(device)
        found = f"{len(listed)} found" + (f", {refused}" if refused and listed else "")
        remedy = "join the group video, as the udev rules of libopenni2-0 have it, and replug it"
        raise SourceLost(f"no {self._name} ({found}): plug in its USB; if lsusb lists it, {remedy}")

    def _addresses(self) -> list[bytes]:
        infos, count = ctypes.POINTER(libopenni2.DeviceInfo)(), ctypes.c_int()
        status = self._library.oniGetDeviceList(ctypes.byref(infos), ctypes.byref(count))
        self._check("cannot be looked for", status)
        addresses = [infos[number].uri for number in range(count.value)]
        self._library.oniReleaseDeviceList(infos)
        return addresses

    def _serial(self, device: Handle) -> str:
        text = ctypes.create_string_buffer(256)
        size = ctypes.c_int(len(text))
        number = libopenni2.DEVICE_SERIAL_NUMBER
        status = self._library.oniDeviceGetProperty(device, number, text, ctypes.byref(size))
        return text.value.decode(errors="replace") if status == libopenni2.OK else ""

    def _create_stream(self, release: ExitStack) -> Handle:
        if self._library.oniDeviceIsPropertySupported(self._device, libopenni2.DEVICE_PLAYBACK_SPEED):
            raise ConfigError(f"capture.serial: {self._name} is a recording: name a camera")
        stream = Handle()
        created = self._library.oniDeviceCreateStream(self._device, libopenni2.SENSOR_DEPTH, ctypes.byref(stream))
        self._check("has no depth", created)
        release.callback(self._library.oniStreamDestroy, stream)
        return stream

    def _set_mode(self, config: CaptureConfig) -> libopenni2.VideoMode:
        """Set size, rate and unit, and that left is left: PrimeSense's driver mirrors unless told not to."""
        info = self._library.oniDeviceGetSensorInfo(self._device, libopenni2.SENSOR_DEPTH).contents
        offered: list[libopenni2.VideoMode] = info.modes[: info.mode_count]
        modes = [each for each in offered if each.pixel_format in libopenni2.UNITS]
        mode = modes[best_mode([(each.width, each.height, each.fps) for each in modes], config.size, self._name)]
        if bytes(mode) != bytes(self._mode()):  # a camera that has one mode may refuse to set even that
            self._set("size", libopenni2.STREAM_VIDEO_MODE, mode)
        if self._library.oniStreamIsPropertySupported(self._stream, libopenni2.STREAM_MIRRORING):
            self._set("mirroring", libopenni2.STREAM_MIRRORING, ctypes.c_int(0))
        return mode

    def _mode(self) -> libopenni2.VideoMode:
        mode = libopenni2.VideoMode()
        size = ctypes.c_int(ctypes.sizeof(mode))
        number = libopenni2.STREAM_VIDEO_MODE
        self._library.oniStreamGetProperty(self._stream, number, ctypes.byref(mode), ctypes.byref(size))
        return mode

    def _set(self, what: str, number: int, value: libopenni2.VideoMode | ctypes.c_int) -> None:
        status = self._library.oniStreamSetProperty(self._stream, number, ctypes.byref(value), ctypes.sizeof(value))
        self._check(f"refuses its {what}", status)

    def _told(self, number: int, value: Value) -> float:
        """A property of the stream, 0 where the camera does not tell it."""
        size = ctypes.c_int(ctypes.sizeof(value))
        status = self._library.oniStreamGetProperty(self._stream, number, ctypes.byref(value), ctypes.byref(size))
        return float(value.value) if status == libopenni2.OK else 0.0

    def _describe(self, mode: libopenni2.VideoMode, config: CaptureConfig) -> Camera:
        """The camera by its own field of view and baseline, or else an Xtion's; OpenNI2 has no distortion."""
        across = self._told(libopenni2.STREAM_HORIZONTAL_FOV, ctypes.c_float()) or FIELD_OF_VIEW[0]
        upright = self._told(libopenni2.STREAM_VERTICAL_FOV, ctypes.c_float()) or FIELD_OF_VIEW[1]
        fx = mode.width / 2 / math.tan(across / 2)
        fy = mode.height / 2 / math.tan(upright / 2)
        intrinsics = Intrinsics(fx, fy, (mode.width - 1) / 2, (mode.height - 1) / 2)
        told = self._told(libopenni2.STREAM_EMITTER_DISTANCE, ctypes.c_double()) / 100
        baseline = told if 0.0 < told <= WIDEST_BASELINE else KINECT_BASELINE
        floor = config.mounted_floor()
        return Camera(mode.width, mode.height, intrinsics, KINECT_RANGE, floor, noise(baseline), baseline)

    def _millimetres(self, frame: libopenni2.Frame) -> NDArray[np.uint16]:
        """A frame's depths (rows, columns) [mm], 0 = no return; a copy."""
        if (frame.width, frame.height) != (self._camera.width, self._camera.height):
            sizes = f"{frame.width}x{frame.height}, expected {self._camera.width}x{self._camera.height}"
            raise SourceLost(f"{self._name} sends images of {sizes}: {REPLUG}")
        per_row = frame.stride // 2
        buffer = (ctypes.c_uint16 * (per_row * frame.height)).from_address(frame.data)
        rows = np.array(buffer).reshape(frame.height, per_row)[:, : frame.width]
        return rows if self._unit == 1.0 else np.rint(rows * self._unit).astype(np.uint16)
