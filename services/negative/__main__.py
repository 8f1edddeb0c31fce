"""Where the floor ends: holes, descending stairs and kerbs, as laser scans of each depth image."""

from __future__ import annotations

from cliffscan.common.contract import topics
from cliffscan.common.runtime.service import Service, main
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.publishers import ScanPublishers
from cliffscan.services.negative.scans import compile_kernels, negative_scans


def serve(service: Service[NegativeConfig]) -> None:
    """Answer each depth image with the scans of where the floor ends."""
    config = service.config
    compile_kernels(config)
    publishers = ScanPublishers(service)
    for image in service.newest(topics.DEPTH):
        publishers.publish(negative_scans(image, config, publishers.subscribed()))


if __name__ == "__main__":
    main("negative", NegativeConfig, serve)
