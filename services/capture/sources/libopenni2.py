"""The part of OpenNI2's C interface that a depth stream needs: structures, constants and prototypes.

Source: OniCAPI.h, OniCTypes.h, OniCProperties.h and PS1080.h of version 2.2. Every function returns a status but those
whose result is given below; its handles are pointers.
"""

import ctypes

from cliffscan.services.capture.sources import shared_library
from cliffscan.services.capture.sources.shared_library import Prototypes

NAMES = ("libOpenNI2.so.0", "libOpenNI2.so")  # as Debian and as the vendors call it
API_VERSION = 2002  # 1000 · major + minor

OK = 0
TIME_OUT = 102
SENSOR_DEPTH = 3
UNITS = {100: 1.0, 101: 0.1}  # [mm] of a pixel's value in the formats DEPTH_1_MM and DEPTH_100_UM

DEVICE_SERIAL_NUMBER = 3  # char[]
DEVICE_PLAYBACK_SPEED = 100  # which only a recording has
STREAM_HORIZONTAL_FOV = 1  # float [rad]
STREAM_VERTICAL_FOV = 2  # float [rad]
STREAM_VIDEO_MODE = 3
STREAM_MIRRORING = 7  # int
STREAM_EMITTER_DISTANCE = 0x1080100E  # double [cm], of PrimeSense's driver: from the projector to the depth camera

Handle = ctypes.c_void_p


class VideoMode(ctypes.Structure):
    """OniVideoMode."""

    pixel_format: int
    width: int
    height: int
    fps: int

    _fields_ = (
        ("pixel_format", ctypes.c_int),
        ("width", ctypes.c_int),
        ("height", ctypes.c_int),
        ("fps", ctypes.c_int),
    )


class SensorInfo(ctypes.Structure):
    """OniSensorInfo: what a sensor can send."""

    _fields_ = (
        ("sensor_type", ctypes.c_int),
        ("mode_count", ctypes.c_int),
        ("modes", ctypes.POINTER(VideoMode)),
    )


class DeviceInfo(ctypes.Structure):
    """OniDeviceInfo."""

    uri: bytes

    _fields_ = (
        ("uri", ctypes.c_char * 256),
        ("vendor", ctypes.c_char * 256),
        ("name", ctypes.c_char * 256),
        ("usb_vendor", ctypes.c_uint16),
        ("usb_product", ctypes.c_uint16),
    )


class Frame(ctypes.Structure):
    """OniFrame: one image, which the library owns until it is released."""

    size: int
    data: int
    width: int
    height: int
    stride: int

    _fields_ = (
        ("size", ctypes.c_int),  # [bytes]
        ("data", ctypes.c_void_p),
        ("sensor_type", ctypes.c_int),
        ("timestamp", ctypes.c_uint64),  # [us] of the device's own clock
        ("index", ctypes.c_int),
        ("width", ctypes.c_int),
        ("height", ctypes.c_int),
        ("mode", VideoMode),
        ("cropped", ctypes.c_int),
        ("crop_x", ctypes.c_int),
        ("crop_y", ctypes.c_int),
        ("stride", ctypes.c_int),  # [bytes] of a row
    )


_Int = ctypes.POINTER(ctypes.c_int)
_Infos = ctypes.POINTER(DeviceInfo)
_Frame = ctypes.POINTER(Frame)
_PROTOTYPES: Prototypes = {
    "oniInitialize": (ctypes.c_int, (ctypes.c_int,)),
    "oniGetExtendedError": (ctypes.c_char_p, ()),
    "oniGetDeviceList": (ctypes.c_int, (ctypes.POINTER(_Infos), _Int)),
    "oniReleaseDeviceList": (ctypes.c_int, (_Infos,)),
    "oniDeviceOpen": (ctypes.c_int, (ctypes.c_char_p, ctypes.POINTER(Handle))),
    "oniDeviceClose": (ctypes.c_int, (Handle,)),
    "oniDeviceGetProperty": (ctypes.c_int, (Handle, ctypes.c_int, Handle, _Int)),
    "oniDeviceIsPropertySupported": (ctypes.c_int, (Handle, ctypes.c_int)),  # a truth
    "oniDeviceGetSensorInfo": (ctypes.POINTER(SensorInfo), (Handle, ctypes.c_int)),
    "oniDeviceCreateStream": (ctypes.c_int, (Handle, ctypes.c_int, ctypes.POINTER(Handle))),
    "oniStreamDestroy": (None, (Handle,)),
    "oniStreamStart": (ctypes.c_int, (Handle,)),
    "oniStreamStop": (None, (Handle,)),
    "oniStreamGetProperty": (ctypes.c_int, (Handle, ctypes.c_int, Handle, _Int)),
    "oniStreamSetProperty": (ctypes.c_int, (Handle, ctypes.c_int, Handle, ctypes.c_int)),
    "oniStreamIsPropertySupported": (ctypes.c_int, (Handle, ctypes.c_int)),  # a truth
    "oniWaitForAnyStream": (ctypes.c_int, (ctypes.POINTER(Handle), ctypes.c_int, _Int, ctypes.c_int)),  # [ms]
    "oniStreamReadFrame": (ctypes.c_int, (Handle, ctypes.POINTER(_Frame))),
    "oniFrameRelease": (None, (_Frame,)),
}


def load() -> ctypes.CDLL:
    """The installed library, its functions typed. Raises OSError where there is none."""
    return shared_library.load(NAMES, _PROTOTYPES)
