"""The part of libfreenect's C interface that a depth stream needs: structures, constants and prototypes.

Source: libfreenect.h of version 0.5.3. Every function returns a negative number when it fails.
"""

import ctypes

from cliffscan.services.capture.sources import shared_library
from cliffscan.services.capture.sources.shared_library import Prototypes

NAMES = ("libfreenect.so.0.5", "libfreenect.so.0", "libfreenect.so")  # as Debian, others and a local build call it

DEVICE_CAMERA = 0x02
RESOLUTION_MEDIUM = 1  # 640 x 480
DEPTH_11BIT = 0  # the sensor's own disparity, 0 ... 2047
DEPTH_MM = 5  # millimetres by the factory calibration of this very device

LOG_FATAL, LOG_ERROR, LOG_WARNING, LOG_NOTICE, LOG_INFO = range(5)

LIBUSB_ERROR_INTERRUPTED = -10  # libusb's codes pass through process_events_timeout

DepthCallback = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32)  # device, pixels, ticks
LogCallback = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p)  # context, level, message


class FrameMode(ctypes.Structure):
    """freenect_frame_mode: the layout of one frame's buffer."""

    reserved: int
    resolution: int
    format: int
    bytes: int
    width: int
    height: int
    data_bits_per_pixel: int
    padding_bits_per_pixel: int
    framerate: int
    is_valid: int

    _fields_ = (
        ("reserved", ctypes.c_uint32),
        ("resolution", ctypes.c_int32),
        ("format", ctypes.c_int32),
        ("bytes", ctypes.c_int32),
        ("width", ctypes.c_int16),
        ("height", ctypes.c_int16),
        ("data_bits_per_pixel", ctypes.c_int8),
        ("padding_bits_per_pixel", ctypes.c_int8),
        ("framerate", ctypes.c_int8),
        ("is_valid", ctypes.c_int8),
    )


class Timeval(ctypes.Structure):
    """struct timeval: a time span, whole seconds and microseconds."""

    _fields_ = (("seconds", ctypes.c_long), ("microseconds", ctypes.c_long))


_Handle = ctypes.c_void_p
_PROTOTYPES: Prototypes = {
    "freenect_init": (ctypes.c_int, (ctypes.POINTER(_Handle), ctypes.c_void_p)),
    "freenect_shutdown": (ctypes.c_int, (_Handle,)),
    "freenect_set_log_level": (None, (_Handle, ctypes.c_int)),
    "freenect_set_log_callback": (None, (_Handle, LogCallback)),
    "freenect_num_devices": (ctypes.c_int, (_Handle,)),
    "freenect_select_subdevices": (None, (_Handle, ctypes.c_int)),
    "freenect_open_device": (ctypes.c_int, (_Handle, ctypes.POINTER(_Handle), ctypes.c_int)),
    "freenect_close_device": (ctypes.c_int, (_Handle,)),
    "freenect_find_depth_mode": (FrameMode, (ctypes.c_int, ctypes.c_int)),
    "freenect_set_depth_mode": (ctypes.c_int, (_Handle, FrameMode)),
    "freenect_set_depth_callback": (None, (_Handle, DepthCallback)),
    "freenect_start_depth": (ctypes.c_int, (_Handle,)),
    "freenect_stop_depth": (ctypes.c_int, (_Handle,)),
    "freenect_process_events_timeout": (ctypes.c_int, (_Handle, ctypes.POINTER(Timeval))),
}


def load() -> ctypes.CDLL:
    """The installed library, its functions typed. Raises OSError where there is none."""
    return shared_library.load(NAMES, _PROTOTYPES)
