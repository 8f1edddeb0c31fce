"""The positive and the negative scan of each frame, and any extra inputs, as one scan for any SLAM or planner."""

from cliffscan.common.contract import topics
from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.latest_queue import LatestQueue
from cliffscan.common.runtime.service import PATIENCE, Service, main
from cliffscan.services.fuse.config import FuseConfig
from cliffscan.services.fuse.fuser import ROOM, Fuser

SIDES = {"positive": topics.SCAN_POSITIVE, "negative": topics.SCAN_NEGATIVE}


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
