"""What stands on the floor in the robot's way, as a laser scan of each depth image."""

from __future__ import annotations

from cliffscan.common.contract import topics
from cliffscan.common.contract.depth_codec import compile_loops
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.common.runtime.service import Service, main
from cliffscan.services.positive.config import PositiveConfig
from cliffscan.services.positive.robot_height import RobotHeight
from cliffscan.services.positive.scan import positive_scan


def serve(service: Service[PositiveConfig]) -> None:
    """Answer each depth image with the scan of what stands on the floor."""
    compile_loops()
    positive_scan(WARMUP_IMAGE, service.config)
    height = RobotHeight(service)
    publisher = service.publisher(topics.SCAN_POSITIVE)
    for image in service.newest(topics.DEPTH):
        publisher.put(positive_scan(image, height.config))
        service.metrics.output(image.stamp)


if __name__ == "__main__":
    main("positive", PositiveConfig, serve)
