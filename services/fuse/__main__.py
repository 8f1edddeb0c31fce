"""The positive and the negative scan of each frame, and any extra inputs, as one scan for any SLAM or planner."""

import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import PATIENCE, Service, main
from cliffscan.services.fuse.config import ExtraInput, FuseConfig
from cliffscan.services.fuse.fusion import GridMismatch, fuse
from cliffscan.services.fuse.pairing import Pair, Pairing

SIDES = {"positive": topics.SCAN_POSITIVE, "negative": topics.SCAN_NEGATIVE}
ROOM = 64  # scans that may wait to be looked at


class Fuser:
    """Collects scans and publishes what they make together."""

    def __init__(self, service: Service[FuseConfig]) -> None:
        self._service = service
        self._inputs = service.config.inputs
        self._pairing = Pairing(service.config.timeout)
        self._newest: dict[str, LaserScan] = {}
        self._publisher = service.publisher(topics.SCAN_FUSED)

    def take(self, name: str, scan: LaserScan) -> None:
        """Take in one scan; publish where it completes a frame."""
        if name in self._inputs:
            self._newest[name] = scan
        else:
            pair = self._pairing.add(name, scan, time.monotonic())
            if pair:
                self._publish(pair)

    def drop_late(self) -> None:
        """Give up scans whose partner does not come."""
        for why in self._pairing.drop_late(time.monotonic()):
            self._service.metrics.warn_limited("incomplete", why)

    def _publish(self, pair: Pair) -> None:
        metrics = self._service.metrics
        extras = self._fresh(pair.positive.stamp)
        missing = self._inputs.keys() - extras.keys()
        self._service.note = f"no fresh scan of {', '.join(sorted(missing))}" if missing else ""
        if missing:
            metrics.warn_limited("incomplete", f"stamp {pair.positive.stamp}: {self._service.note}")
            return
        try:
            self._publisher.put(fuse(pair, extras))
            metrics.output(pair.positive.stamp)
        except GridMismatch as error:
            metrics.warn_limited("mismatch", str(error))

    def _fresh(self, stamp: int) -> dict[str, tuple[ExtraInput, LaserScan]]:
        """The newest scan of every extra input that has one of about this stamp [ns]."""
        return {
            name: (self._inputs[name], scan)
            for name, scan in self._newest.items()
            if abs(scan.stamp - stamp) <= self._inputs[name].max_age * 1e9
        }


def serve(service: Service[FuseConfig]) -> None:
    """Publish one scan for every frame whose scans are all there."""
    queue: LatestQueue[tuple[str, LaserScan]] = LatestQueue(ROOM)
    fuser = Fuser(service)

    def listen(name: str, topic: Topic[LaserScan]) -> None:
        def accept(scan: LaserScan) -> None:
            if not queue.put((name, scan)):
                service.metrics.count("overtaken")

        service.receive(topic, accept, ROOM)

    for name, topic in SIDES.items():
        listen(name, topic)
    for name, source in service.config.inputs.items():
        listen(name, topics.scan(source.key))
    service.ready()
    while service.running:
        arrived = queue.get(PATIENCE)
        if arrived:
            fuser.take(*arrived)
        fuser.drop_late()


if __name__ == "__main__":
    main("fuse", FuseConfig, serve)
