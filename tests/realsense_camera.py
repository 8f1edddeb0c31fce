"""A RealSense camera without hardware: librealsense's own software device, which real library calls open and read.

A process of capture with such a camera: `python -m tests.realsense_camera OPTION ...`, the options are capture's.
"""

import runpy
import threading
import time

import numpy as np
import pyrealsense2 as rs

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.services.capture.sources import realsense
from tests import scenes

SIZE = (320, 240)
INTRINSICS = Intrinsics(211.0, 210.0, 158.5, 121.5)
BASELINE = 0.095  # [m] a D455's
CAMERA = Camera(*SIZE, INTRINSICS, (0.2, 4.5), FloorPlane.from_mount(0.30))
SCENE = scenes.depth(CAMERA, wall=2.0)  # [mm]


class SoftwareCamera:
    """A camera that sends SCENE at 30 Hz, in `unit` [m] and with one unit of noise, from the first of its sizes."""

    def __init__(self, serial="0123", unit=1e-4, baseline=BASELINE, coefficients=(0.0,) * 5, sizes=(SIZE,)) -> None:
        self.unit, self.domain, self.stamps = unit, rs.timestamp_domain.system_time, []
        self._plugged = True
        self._device = rs.software_device()
        self._device.register_info(rs.camera_info.serial_number, serial)
        self._device.register_info(rs.camera_info.name, "Intel RealSense D455")
        self._sensor = self._device.add_sensor("Stereo Module")
        self._sensor.add_read_only_option(rs.option.depth_units, unit)
        if baseline:
            self._sensor.add_read_only_option(rs.option.stereo_baseline, 1000 * baseline)
        self._profiles = [self._stream(number, size, coefficients) for number, size in enumerate(sizes)]
        self._pixels = np.rint(SCENE * (1e-3 / unit)).astype(np.uint16)
        self._ended, self._rounds = threading.Event(), 0
        self._sender = threading.Thread(target=self._send)
        self._sender.start()

    def __getattr__(self, name):
        return getattr(self._device, name)

    def is_connected(self):
        return self._plugged

    def unplug(self):
        self._plugged = False
        self.close()

    def close(self):
        """Fall silent."""
        self._ended.set()
        self._sender.join()

    def _stream(self, number, size, coefficients):
        told = rs.intrinsics()
        told.width, told.height = size
        told.fx, told.fy, told.ppx, told.ppy = INTRINSICS
        told.model, told.coeffs = rs.distortion.brown_conrady, list(coefficients)
        stream = rs.video_stream()
        stream.type, stream.index, stream.uid, stream.fmt = rs.stream.depth, 0, number + 1, rs.format.z16
        stream.width, stream.height = size
        stream.fps, stream.bpp, stream.intrinsics = 30, 2, told
        return self._sensor.add_video_stream(stream).as_video_stream_profile()

    def _send(self):
        dice = np.random.default_rng(1)
        while not self._ended.wait(1 / 30):
            frame = rs.software_video_frame()
            noisy = self._pixels + dice.integers(0, 2, self._pixels.shape, dtype=np.uint16)
            frame.pixels, frame.stride, frame.bpp = np.where(self._pixels, noisy, 0).astype(np.uint16), 2 * SIZE[0], 2
            frame.timestamp, frame.domain = time.time() * 1e3, self.domain
            frame.depth_units, frame.frame_number, frame.profile = self.unit, self._rounds, self._profiles[0]
            self._rounds += 1
            self.stamps.append(frame.timestamp)
            self._sensor.on_video_frame(frame)


if __name__ == "__main__":
    camera = SoftwareCamera()
    realsense.connected = lambda: [camera]
    try:
        runpy.run_module("services.capture", run_name="__main__")
    finally:
        camera.close()
