"""What fuse publishes of the scans that it receives, and when."""

import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.perception.known_ground import safe_scan
from cliffscan.common.runtime.service import Service
from cliffscan.services.fuse.config import ExtraInput, FuseConfig
from cliffscan.services.fuse.fusion import GridMismatch, fuse
from cliffscan.services.fuse.pairing import Pair, Pairing

ROOM = 64  # scans that may wait to be looked at


class Fuser:
    """Collects scans and publishes what they make together."""

    def __init__(self, service: Service[FuseConfig]) -> None:
        self._service = service
        self._inputs = service.config.inputs
        self._pairing = Pairing(service.config.timeout)
        self._newest: dict[str, LaserScan] = {}
        self._publisher = service.publisher(topics.SCAN_FUSED)
        self._safe = service.publisher(topics.SCAN_SAFE)

    def take(self, name: str, scan: LaserScan) -> None:
        """Take in one scan; publish where it completes a frame."""
        if name in self._inputs:
            self._newest[name] = scan
        else:
            pair = self._pairing.add(name, scan, time.monotonic())
            if pair:
                self.publish(pair)

    def drop_late(self) -> None:
        """Give up scans whose partner does not come."""
        for why in self._pairing.drop_late(time.monotonic()):
            self._service.metrics.warn_limited("incomplete", why)

    def publish(self, pair: Pair) -> bool:
        """Publish the scan of a frame; False where an extra input has none that is fresh, or the beams differ."""
        metrics = self._service.metrics
        extras = self._fresh(pair.positive.stamp)
        missing = self._inputs.keys() - extras.keys()
        self._service.note = f"no fresh scan of {', '.join(sorted(missing))}" if missing else ""
        if missing:
            metrics.warn_limited("incomplete", f"stamp {pair.positive.stamp}: {self._service.note}")
            return False
        try:
            fused = fuse(pair, extras)
        except GridMismatch as error:
            metrics.warn_limited("mismatch", str(error))
            return False
        self._publisher.put(fused)
        if self._safe.has_subscribers:
            self._safe.put(safe_scan(fused))
        metrics.output(pair.positive.stamp)
        return True

    def _fresh(self, stamp: int) -> dict[str, tuple[ExtraInput, LaserScan]]:
        """The newest scan of every extra input that has one of about this stamp [ns]."""
        return {
            name: (self._inputs[name], scan)
            for name, scan in self._newest.copy().items()  # another thread adds to it
            if abs(scan.stamp - stamp) <= self._inputs[name].max_age * 1e9
        }
