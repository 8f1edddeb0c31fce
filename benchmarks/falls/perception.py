"""From a depth frame to the fused scan, as capture and perception make it, without processes between."""

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from cliffscan.common.contract.camera import Camera
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.services.capture.floor.tracker import FloorTracker
from cliffscan.services.perception.perceive import Settings, perceive
from cliffscan.services.positive.scan import positive_scan
from cliffscan.simulator.kinect import Millimetres

Mode = Literal["default", "paper", "positive"]
Perception = Callable[[Millimetres, int], LaserScan]  # of a frame (rows, columns) [mm] and its stamp [ns]

FRAME = "camera_depth_optical_frame"
PAPER = Settings.of_profile("paper")


def perception(mode: Mode, camera: Camera, settings: Settings) -> Perception:
    """What makes the scans of one robot, whose camera is mounted like that as far as anybody knows.

    default: the tracked floor and what the services do by `settings`. paper: its two algorithms on the plane
    of the mount. positive: the tracked floor and what stands on it, no edges.
    """
    if mode == "paper":
        return lambda depth, stamp: perceive(_image(depth, stamp, camera), PAPER).fused
    tracker = FloorTracker(camera.floor)

    def tracked(depth: Millimetres, stamp: int) -> DepthImage:
        return _image(depth, stamp, replace(camera, floor=tracker.update(depth, camera)))

    if mode == "positive":
        return lambda depth, stamp: positive_scan(tracked(depth, stamp), settings.positive)
    return lambda depth, stamp: perceive(tracked(depth, stamp), settings).fused


def _image(depth: Millimetres, stamp: int, camera: Camera) -> DepthImage:
    return DepthImage.pack(0, stamp, FRAME, depth, camera, RAW)
