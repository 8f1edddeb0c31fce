"""What stands on the floor in the robot's way, as a laser scan of each depth image."""

from __future__ import annotations

from cliffscan.common.contract import topics
from cliffscan.common.contract.evidence import Evidence
from cliffscan.common.contract.messages import DepthImage
from cliffscan.common.perception.combine import Beams
from cliffscan.common.perception.scans import BLANK, laser_scan, points
from cliffscan.common.runtime.service import Service, main
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.projection import projection


def obstacles(image: DepthImage, config: PositiveConfig) -> Beams:
    """The nearest obstacle in each beam."""
    seen = points(image, config, lower_than=config.robot_height)
    ranges = projection(seen, config.grid(), config.floor_band, config.robot_height, config.slope)
    return Beams.of(ranges, Evidence.POSITIVE).within(config.reach(image.camera))


def serve(service: Service[PositiveConfig]) -> None:
    """Answer each depth image with the scan of what stands on the floor."""
    config = service.config
    obstacles(BLANK, config)
    publisher = service.publisher(topics.SCAN_POSITIVE)
    for image in service.newest(topics.DEPTH):
        publisher.put(laser_scan(image, obstacles(image, config), config))
        service.tally.output(image.stamp)


if __name__ == "__main__":
    main("positive", PositiveConfig, serve)
