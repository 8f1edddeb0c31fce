"""Where the floor ends: holes, descending stairs and kerbs, as laser scans of each depth image."""

from __future__ import annotations

from common import topics
from common.combine import combine
from common.scans import BLANK, laser_scan
from common.service import Service, main
from services.negative.config import NegativeConfig
from services.negative.methods import beams_by_method


def serve(service: Service[NegativeConfig]) -> None:
    """Answer each depth image with the scan of every method and the combination of all."""
    config = service.config
    beams_by_method(BLANK, config)
    methods = {method: service.publisher(topics.scan_negative(method)) for method in config.methods}
    combined = service.publisher(topics.SCAN_NEGATIVE)
    for image in service.newest(topics.DEPTH):
        found = beams_by_method(image, config)
        combined.put(laser_scan(image, combine(list(found.values())), config))
        service.tally.output(image.stamp)
        for method, beams in found.items():
            methods[method].put(laser_scan(image, beams, config))


if __name__ == "__main__":
    main("negative", NegativeConfig, serve)
