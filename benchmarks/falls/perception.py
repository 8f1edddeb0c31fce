"""From a depth frame to the fused scan, as capture, negative, positive and fuse do it, without processes between."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.perception.combine import combine
from cliffscan.common.perception.scans import laser_scan
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.services.fuse.fusion import fuse
from cliffscan.services.fuse.pairing import Pair
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import beams_by_method
from cliffscan.services.positive.__main__ import obstacles
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.simulator.kinect import Millimetres

Mode = Literal["default", "paper", "positive"]
Perception = Callable[[Millimetres, int], LaserScan]  # of a frame (rows, columns) [mm] and its stamp [ns]

FRAME = "camera_depth_optical_frame"
PAPER = NegativeConfig(**NegativeConfig.PROFILES["paper"]), PositiveConfig(**PositiveConfig.PROFILES["paper"])
DEFAULT = NegativeConfig(), PositiveConfig()


def perception(mode: Mode, camera: Camera) -> Perception:
    """What makes the scans of one robot, whose camera is mounted like that as far as anybody knows.

    default: the tracked floor and what the services do unless told otherwise. paper: its two algorithms on the plane
    of the mount. positive: the tracked floor and what stands on it, no edges.
    """
    if mode == "paper":
        return lambda depth, stamp: _fused(_image(depth, stamp, camera), *PAPER)
    tracker = FloorTracker(camera.floor)

    def tracked(depth: Millimetres, stamp: int) -> DepthImage:
        return _image(depth, stamp, replace(camera, floor=tracker.update(depth, camera)))

    if mode == "positive":
        return lambda depth, stamp: _positive(tracked(depth, stamp), DEFAULT[1])
    return lambda depth, stamp: _fused(tracked(depth, stamp), *DEFAULT)


def _image(depth: Millimetres, stamp: int, camera: Camera) -> DepthImage:
    return DepthImage.pack(0, stamp, FRAME, depth, camera, RAW)


def _positive(image: DepthImage, config: PositiveConfig) -> LaserScan:
    return laser_scan(image, obstacles(image, config), config)


def _fused(image: DepthImage, negative: NegativeConfig, positive: PositiveConfig) -> LaserScan:
    found = beams_by_method(image, negative, negative.methods)
    edges = laser_scan(image, combine([found[method] for method in negative.methods]), negative)
    return fuse(Pair(_positive(image, positive), edges), {})
