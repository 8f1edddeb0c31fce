"""Where the floor ends: holes, descending stairs and kerbs, as laser scans of each depth image."""

from __future__ import annotations

import threading

from cliffscan.common.contract import topics
from cliffscan.common.perception.combine import combine
from cliffscan.common.perception.scans import BLANK, laser_scan
from cliffscan.common.runtime.service import Service, main
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import RUN, beams_by_method


def serve(service: Service[NegativeConfig]) -> None:
    """Answer each depth image with the combined scan, and with that of every method it is made of or somebody hears."""
    config = service.config
    beams_by_method(BLANK, config, config.methods)
    threading.Thread(target=beams_by_method, args=(BLANK, config, RUN), daemon=True).start()  # compiles the others
    scans = {method: service.publisher(topics.scan_negative(method)) for method in RUN}
    combined = service.publisher(topics.SCAN_NEGATIVE)
    for image in service.newest(topics.DEPTH):
        wanted = [method for method in RUN if method in config.methods or scans[method].heard]
        found = beams_by_method(image, config, wanted)
        beams = combine([found[method] for method in config.methods])
        combined.put(laser_scan(image, beams, config))
        service.tally.output(image.stamp)
        for method in wanted:
            scans[method].put(laser_scan(image, found[method], config))


if __name__ == "__main__":
    main("negative", NegativeConfig, serve)
