"""From a depth image to the scan of what stands on the floor."""

from __future__ import annotations

from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.perception.combine import beams_with, within
from cliffscan.common.perception.floor_points import floor_points
from cliffscan.common.perception.scans import laser_scan
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.projection import projection


def positive_scan(image: DepthImage, config: PositiveConfig) -> LaserScan:
    """The nearest obstacle in each beam."""
    seen = floor_points(image.depth, image.camera, config.range_min, lower_than=config.robot_height)
    noise = 0.0 if config.flat_floor else image.camera.noise
    floor = config.floor_band, config.robot_height, config.slope, noise, config.lowest_rise
    ranges = projection(seen, config.grid(), *floor)
    return laser_scan(image, within(beams_with(ranges, Evidence.POSITIVE), config.reach(image.camera)), config)
