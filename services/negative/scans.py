"""From a depth image to the scans of where the floor ends: each method's, and all of them combined."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.perception.combine import combine
from cliffscan.common.perception.scans import laser_scan
from cliffscan.services.negative.config import Method, NegativeConfig
from cliffscan.services.negative.methods import beams_by_method


class NegativeScans(NamedTuple):
    """The scans of one depth image; `combined` is of the configured methods. Paper: algorithm 3."""

    by_method: dict[Method, LaserScan]
    combined: LaserScan


def negative_scans(image: DepthImage, config: NegativeConfig, methods: Collection[Method] = ()) -> NegativeScans:
    """The scans of the configured methods, and of further `methods`."""
    found = beams_by_method(image, config, dict.fromkeys((*config.methods, *methods)))
    combined = combine([found[method] for method in config.methods])
    by_method = {method: laser_scan(image, beams, config) for method, beams in found.items()}
    return NegativeScans(by_method, laser_scan(image, combined, config))
