"""Where negative publishes the scans of a frame."""

from cliffscan.common.contract import topics
from cliffscan.common.runtime.service import Service
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.methods import METHODS
from cliffscan.services.negative.scans import NegativeScans


class ScanPublishers:
    """Publishes the combined scan, and that of every method that it is made of or that has subscribers."""

    def __init__(self, service: Service[NegativeConfig]) -> None:
        self._metrics = service.metrics
        self._combined = service.publisher(topics.SCAN_NEGATIVE)
        self._of_method = {method: service.publisher(topics.SCAN_OF_METHOD.named(method)) for method in METHODS}

    def subscribed(self) -> list[str]:
        """The methods whose own scans have subscribers."""
        return [method for method, publisher in self._of_method.items() if publisher.has_subscribers]

    def publish(self, scans: NegativeScans) -> None:
        """Publish the scans of a frame."""
        self._combined.put(scans.combined)
        self._metrics.output(scans.combined.stamp)
        for method, scan in scans.by_method.items():
            self._of_method[method].put(scan)
