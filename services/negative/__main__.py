"""Where the floor ends: holes, descending stairs and kerbs, as laser scans of each depth image."""

from __future__ import annotations

import threading

from cliffscan.common.contract import topics
from cliffscan.common.perception.scans import WARMUP_IMAGE
from cliffscan.common.runtime.service import Service, main
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import RUN
from cliffscan.services.negative.scans import negative_scans


def serve(service: Service[NegativeConfig]) -> None:
    """Publish each depth image's combined scan, and that of every method that it is made of or that has subscribers."""
    config = service.config
    negative_scans(WARMUP_IMAGE, config)
    compile_others = threading.Thread(target=negative_scans, args=(WARMUP_IMAGE, config, RUN), daemon=True)
    compile_others.start()
    publishers = {method: service.publisher(topics.SCAN_OF_METHOD.named(method)) for method in RUN}
    combined = service.publisher(topics.SCAN_NEGATIVE)
    for image in service.newest(topics.DEPTH):
        scans = negative_scans(image, config, [method for method in RUN if publishers[method].has_subscribers])
        combined.put(scans.combined)
        service.metrics.output(image.stamp)
        for method, scan in scans.by_method.items():
            publishers[method].put(scan)


if __name__ == "__main__":
    main("negative", NegativeConfig, serve)
