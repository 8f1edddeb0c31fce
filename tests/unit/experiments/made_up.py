"""A frame with all its scans, of a small made-up scene, as the services would answer it."""

import numpy as np

from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import beams_with, combine
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.common.perception.scans import ImageScanConfig, laser_scan
from cliffscan.services.negative.methods.farthest_point import farthest_point
from cliffscan.services.negative.methods.virtual_floor import virtual_floor
from cliffscan.services.positive.projection import projection
from experiments.frames import Frame
from tests import scenes

NAMES = ("farthest_point", "virtual_floor", "paper", "positive", "fused")
PATHS = {f"scan/{name}": name for name in NAMES}
BAND, ROBOT, FLAT, EXACT = 0.03, 0.42, 0.0, 0.0


def image(name="hole and box", seq=0, stamp=1):
    camera = scenes.camera()
    return DepthImage.pack(seq, stamp, "optical", scenes.depth(camera, **scenes.SCENES[name]), camera, RAW)


def frame(name="hole and box", seq=0, stamp=1):
    depth = image(name, seq, stamp)
    config = ImageScanConfig(beams=80)
    seen, grid = floor_points(depth.depth, depth.camera), config.grid()
    negative = [
        beams_with(farthest_point(seen, grid, BAND), Evidence.FARTHEST_FLOOR),
        beams_with(virtual_floor(seen, grid, BAND), Evidence.DROP),
    ]
    positive = beams_with(projection(seen, grid, BAND, ROBOT, FLAT, EXACT), Evidence.POSITIVE)
    beams = [*negative, combine(negative), positive, combine([positive, combine(negative)])]
    return Frame(depth, {name: laser_scan(depth, each, config) for name, each in zip(NAMES, beams, strict=True)})


def blank_frame():
    """A frame in which nothing was seen at all."""
    depth = image()
    dark = DepthImage.pack(0, 1, "optical", np.zeros_like(depth.depth), depth.camera, RAW)
    config = ImageScanConfig(beams=80)
    unseen = beams_with(np.full(80, np.nan, np.float32), Evidence.NOTHING)
    return Frame(dark, {name: laser_scan(dark, unseen, config) for name in NAMES})
