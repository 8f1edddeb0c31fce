"""Where the floor ends: holes, descending stairs and kerbs, as laser scans of each depth image."""

from __future__ import annotations

import threading

from cliffscan.common.contract import topics
from cliffscan.common.perception.scans import BLANK
from cliffscan.common.runtime.service import Service, main
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import RUN
from cliffscan.services.negative.scans import negative_scans


def serve(service: Service[NegativeConfig]) -> None:
    """Answer each depth image with the combined scan, and with that of every method it is made of or somebody hears."""
    config = service.config
    negative_scans(BLANK, config)
    threading.Thread(target=negative_scans, args=(BLANK, config, RUN), daemon=True).start()  # compiles the others
    publishers = {method: service.publisher(topics.scan_negative(method)) for method in RUN}
    combined = service.publisher(topics.SCAN_NEGATIVE)
    for image in service.newest(topics.DEPTH):
        scans = negative_scans(image, config, [method for method in RUN if publishers[method].heard])
        combined.put(scans.combined)
        service.tally.output(image.stamp)
        for method, scan in scans.by_method.items():
            publishers[method].put(scan)


if __name__ == "__main__":
    main("negative", NegativeConfig, serve)
