"""A recording by librealsense itself, of its software device: python tests/realsense_file.py FILE UNIT [BASELINE].

FILE ends in .bag for librealsense up to 2.57, in .db3 from 2.58 on. It needs pyrealsense2 and numpy alone, so that one
version after the other can write. UNIT [m] of a depth; BASELINE [m], 0 for a camera with one eye.
"""

import sys

import numpy as np
import pyrealsense2 as rs

SIZE = (32, 24)
INTRINSICS = (21.0, 20.0, 15.5, 12.0)
PIXELS = [
    np.add.outer(4 * np.arange(24), np.arange(32)).astype(np.uint16) + np.uint16(4000 + each) for each in range(3)
]
STAMPS = [1_700_000_000_000_000_000 + 50_000_000 * number for number in range(3)]  # [ns] a double has, as ms
WAIT = 5000  # [ms] at most, for one frame


def record(path, unit, baseline=0.0, compressed=True):
    """Record PIXELS, in `unit` [m], at STAMPS."""
    device = rs.software_device()
    device.register_info(rs.camera_info.name, "a software device")
    sensor = device.add_sensor("Depth Sensor")
    sensor.add_read_only_option(rs.option.depth_units, unit)
    if baseline:
        sensor.add_read_only_option(rs.option.stereo_baseline, 1000 * baseline)
    profile = sensor.add_video_stream(stream()).as_video_stream_profile()
    recorder = rs.recorder(str(path), device, compressed)
    recorded, frames = recorder.query_sensors()[0], rs.frame_queue(1)
    recorded.open(recorded.get_stream_profiles()[0])
    recorded.start(frames)
    for number, (pixels, stamp) in enumerate(zip(PIXELS, STAMPS, strict=True)):
        frame = rs.software_video_frame()
        frame.pixels, frame.stride, frame.bpp, frame.profile = pixels, 2 * SIZE[0], 2, profile
        frame.timestamp, frame.domain = stamp / 1e6, rs.timestamp_domain.system_time
        frame.frame_number, frame.depth_units = number, unit
        sensor.on_video_frame(frame)
        frames.wait_for_frame(WAIT)
    recorded.stop()
    recorded.close()
    return path  # the file is whole when the recorder is gone


def stream():
    """Z16 at 30 Hz."""
    told, found = rs.intrinsics(), rs.video_stream()
    told.width, told.height = SIZE
    told.fx, told.fy, told.ppx, told.ppy = INTRINSICS
    told.model, told.coeffs = rs.distortion.brown_conrady, [0.0] * 5
    found.type, found.index, found.uid, found.fmt = rs.stream.depth, 0, 1, rs.format.z16
    found.width, found.height = SIZE
    found.fps, found.bpp, found.intrinsics = 30, 2, told
    return found


if __name__ == "__main__":
    record(sys.argv[1], *map(float, sys.argv[2:]))
