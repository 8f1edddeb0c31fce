"""A camera's intrinsics, of a sensor_msgs/CameraInfo."""

from typing import NamedTuple

from cliffscan.common.contract.camera import Intrinsics
from cliffscan.services.capture.sources.depth_source import BadFrame

COMPRESSED = "/compressedDepth"  # the end of a topic of compressed images


class Calibration(NamedTuple):
    """A sensor_msgs/CameraInfo: k (9,) of the image as it was taken, p (12,) of the rectified one, both row by row."""

    height: int
    width: int
    distortion: tuple[float, ...]
    k: tuple[float, ...]
    p: tuple[float, ...]

    def intrinsics(self, topic: str) -> Intrinsics:
        """Of the images of `topic`, which are rectified where its name says so. Raises BadFrame for distorted ones."""
        if rectified(topic) and self.p[0]:
            return Intrinsics(self.p[0], self.p[5], self.p[2], self.p[6])
        if any(self.distortion) and not rectified(topic):
            raise BadFrame("its CameraInfo has a distortion: take the rectified topic, as image_rect of image_proc")
        return Intrinsics(self.k[0], self.k[4], self.k[2], self.k[5])


def rectified(topic: str) -> bool:
    """Whether a topic's images are rectified: image_rect, image_rect_raw and the like."""
    return "rect" in topic.removesuffix(COMPRESSED).rpartition("/")[2]


def info_topic(topic: str) -> str:
    """Where a driver publishes the CameraInfo of the images of `topic`: beside them, as image_transport has it."""
    return f"{topic.removesuffix(COMPRESSED).rpartition('/')[0]}/camera_info"
