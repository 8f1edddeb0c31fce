"""Frames of a ROS camera: intrinsics of its CameraInfo, the mount of its transforms, stamps of its images."""

import math

import numpy as np
import pytest

from cliffscan.common.contract.camera import FloorPlane, Intrinsics
from cliffscan.common.contract.description import TURTLEBOT_2
from cliffscan.common.contract.limits import LONGEST_PERIOD
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.ros.calibration import Calibration, info_topic
from cliffscan.services.capture.ros.camera import RosCamera
from cliffscan.services.capture.ros.mount import Joint
from cliffscan.services.capture.ros.pictures import Picture
from cliffscan.services.capture.sources.depth_source import BadFrame

SECOND = 1_000_000_000  # [ns]
K = (3.0, 0.0, 1.0, 0.0, 2.5, 0.5, 0.0, 0.0, 1.0)
P = (2.0, 0.0, 1.1, 0.0, 0.0, 2.1, 0.6, 0.0, 0.0, 0.0, 1.0, 0.0)
INFO = Calibration(2, 3, (0.0,) * 5, K, (0.0,) * 12)
RECT, RAW = "/camera/depth/image_rect_raw", "/camera/depth/image_raw"
FLOOR = Joint("base_link", "eye", (0.2, 0.0, 0.7), (-0.5, 0.5, -0.5, 0.5))


def picture(stamp=5 * SECOND, frame="eye"):
    data = np.array([[0, 500, 1000], [1500, 2000, 65535]], np.uint16).view(np.uint8).ravel()
    return Picture(stamp, frame, 2, 3, "16UC1", False, 6, data)


@pytest.fixture
def make():
    def camera(info=INFO, topic=RECT, **settings):
        made = RosCamera(CaptureConfig(source="ros2", **settings), topic)
        made.calibration = info
        return made

    return camera


def test_a_frame_has_the_intrinsics_of_its_camera_info_and_the_configured_mount(make):
    frame = make(height=0.4, pitch=10.0).frame(picture())
    assert frame.camera.intrinsics == Intrinsics(3.0, 2.5, 1.0, 0.5)
    assert (frame.camera.width, frame.camera.height, frame.camera.range) == (3, 2, (0.5, 4.5))
    assert frame.camera.floor == FloorPlane.from_mount(0.4, math.radians(10.0))
    assert (frame.stamp, frame.place) == (5 * SECOND, TURTLEBOT_2)
    assert frame.depth.tolist() == [[0, 500, 1000], [1500, 2000, 65535]]


def test_the_static_transforms_are_the_mount_and_each_change_is_told_once(make, caplog):
    caplog.set_level("INFO")
    camera = make()
    assert not camera.complete("eye")
    camera.frame(picture())
    camera.frame(picture(6 * SECOND))
    camera.transforms.add([FLOOR])
    assert camera.complete("eye")
    frames = [camera.frame(picture(stamp * SECOND)) for stamp in (7, 8)]
    assert all(frame.camera.floor == pytest.approx((0.0, -1.0, 0.0, 0.7)) for frame in frames)
    assert all(frame.place == pytest.approx((0.2, 0.0, 0.0)) for frame in frames)
    assert [record.message.partition(":")[0] for record in caplog.records] == [
        "the mount as configured, for no static transform leads from base_footprint or base_link to 'eye'",
        "the mount by /tf_static of 'eye'",
    ]


def test_a_period_is_from_one_stamp_to_the_next(make):
    camera = make()
    periods = [camera.frame(picture(stamp)).period for stamp in (SECOND, SECOND + SECOND // 4, 2 * SECOND)]
    assert periods == [None, 0.25, 0.75]


def test_a_period_is_no_longer_than_a_message_can_tell(make):
    """A clock that is set by an hour or by years, as at the first contact with a time server."""
    camera = make()
    camera.frame(picture(5 * SECOND))
    assert camera.frame(picture(1_700_000_000 * SECOND)).period == LONGEST_PERIOD


def test_a_frame_that_comes_again_or_late_is_refused_and_a_clock_set_back_is_not(make):
    camera = make()
    camera.frame(picture(5 * SECOND))
    for stamp in (5 * SECOND, 5 * SECOND - 1, 4 * SECOND + 1):
        with pytest.raises(BadFrame, match="not later than the last"):
            camera.frame(picture(stamp))
    assert camera.frame(picture(4 * SECOND)).period is None
    assert camera.frame(picture(4 * SECOND + SECOND // 2)).period == 0.5


@pytest.mark.parametrize("topic", [RECT, "/depth/image_rect", "/camera/depth/image_rect/compressedDepth"])
def test_a_rectified_image_has_the_intrinsics_of_the_rectified_camera(make, topic):
    info = INFO._replace(p=P, distortion=(0.1, 0.0, 0.0, 0.0, 0.0))
    assert make(info, topic).frame(picture()).camera.intrinsics == Intrinsics(2.0, 2.1, 1.1, 0.6)


def test_an_image_as_it_was_taken_must_have_no_distortion(make):
    assert make(INFO._replace(p=P), RAW).frame(picture()).camera.intrinsics == Intrinsics(3.0, 2.5, 1.0, 0.5)
    with pytest.raises(BadFrame, match="distortion: take the rectified topic"):
        make(INFO._replace(distortion=(0.1, 0.0)), RAW).frame(picture())


@pytest.mark.parametrize(
    ("info", "why"),
    [
        (None, "no CameraInfo on /camera/depth/camera_info: have the driver publish it"),
        (INFO._replace(k=(0.0,) * 9), "intrinsics: fx of 0.0 px is impossible.*correct CameraInfo"),
        (INFO._replace(k=(math.nan,) * 9), "fx of nan"),
        (INFO._replace(width=640, height=480), "fx of 3.0 px is impossible for 640 pixels"),
        (INFO._replace(width=0), "0x2"),
        (INFO._replace(width=4, k=(4.0, *K[1:])), "the image has 3x2 pixels, its CameraInfo 4x2"),
    ],
)
def test_a_camera_info_that_cannot_be_is_told(make, info, why):
    with pytest.raises(BadFrame, match=why) as refused:
        make(info).frame(picture())
    assert "\n" not in str(refused.value)


def test_a_transform_that_cannot_be_is_told(make):
    camera = make()
    camera.transforms.add([FLOOR._replace(rotation=(0.0,) * 4)])
    assert camera.complete("eye")  # waiting helps nothing
    with pytest.raises(BadFrame, match="from base_link to eye is none: correct /tf_static"):
        camera.frame(picture())
    camera.transforms.add([FLOOR._replace(translation=(0.0, 0.0, -0.1))])
    with pytest.raises(BadFrame, match=r"camera height of -0\.1 m is impossible"):
        camera.frame(picture(6 * SECOND))
    camera.transforms.add([FLOOR._replace(translation=(0.0, 1e9, 0.3))])
    with pytest.raises(BadFrame, match=r"place: y of 1e\+09 m is impossible.*: correct /tf_static"):
        camera.frame(picture(7 * SECOND))


def test_an_image_without_a_stamp_is_refused(make):
    with pytest.raises(BadFrame, match="no stamp"):
        make().frame(picture(0))


@pytest.mark.parametrize(
    ("topic", "info"),
    [
        (RECT, "/camera/depth/camera_info"),
        ("/a/image/compressedDepth", "/a/camera_info"),
        ("/image", "/camera_info"),
    ],
)
def test_a_camera_info_is_beside_its_images(topic, info):
    assert info_topic(topic) == info
