"""From a depth image to the scans of where the floor ends: each method's, and all of them combined."""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterable
from typing import NamedTuple

from cliffscan.common.contract.beam_fields import Beams
from cliffscan.common.contract.depth_codec import compile_loops
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.perception.combine import combine, within
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.common.perception.scans import WARMUP_IMAGE, laser_scan
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS


class NegativeScans(NamedTuple):
    """The scans of one depth image; `combined` is of the configured methods. Paper: algorithm 3."""

    by_method: dict[str, LaserScan]
    combined: LaserScan


def negative_scans(image: DepthImage, config: NegativeConfig, methods: Collection[str] = ()) -> NegativeScans:
    """The scans of the configured methods, and of further `methods`."""
    found = beams_by_method(image, config, dict.fromkeys((*config.methods, *methods)))
    by_method = {method: laser_scan(image, beams, config) for method, beams in found.items()}
    if len(config.methods) == 1:
        return NegativeScans(by_method, by_method[config.methods[0]])
    combined = combine([found[method] for method in config.methods])
    return NegativeScans(by_method, laser_scan(image, combined, config))


def beams_by_method(image: DepthImage, config: NegativeConfig, methods: Iterable[str]) -> dict[str, Beams]:
    """What each of these methods finds in `image`."""
    points = floor_points(image.depth, image.camera, config.range_min, lower_than=config.floor_band)
    reach = config.reach(image.camera)
    return {name: within(METHODS[name].find(points, config), reach) for name in methods}


def compile_kernels(config: NegativeConfig) -> None:
    """Compile what the configured methods need, and begin to compile the other methods in a thread."""
    compile_loops()
    negative_scans(WARMUP_IMAGE, config)
    others = threading.Thread(target=negative_scans, args=(WARMUP_IMAGE, config, METHODS), daemon=True)
    others.start()
