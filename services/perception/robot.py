"""What perception does for one robot: it is the robot's negative, positive and fuse, and answers for each of them.

Where a workstation perceives for the same robot too, its fused scans are published while they come in time.
"""

import threading
import time
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from cliffscan.common.contract import topics
from cliffscan.common.contract.message import MessageError
from cliffscan.common.contract.messages import DepthImage, LaserScan
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.config import ServiceConfig
from cliffscan.common.runtime.decoder import Decoder
from cliffscan.common.runtime.service import Service
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.services.fuse.fuser import ROOM, Fuser
from cliffscan.services.fuse.pairing import Pair
from cliffscan.services.negative.publishers import ScanPublishers
from cliffscan.services.perception.handover import Handover
from cliffscan.services.perception.perceive import Settings, sense
from cliffscan.services.positive.robot_height import RobotHeight

NAME = "perception"
OFFERED = topics.at_workstation(topics.SCAN_FUSED)
THEIRS = "the workstation's scans are published"


class RobotPerception:
    """Publishes a robot's scans, and the statuses and tokens of perception and of the three services that it replaces.

    configs: of negative, positive and fuse, by name.
    """

    def __init__(self, bus: Bus, robot: str, configs: Mapping[str, Any], stop: StopSignal) -> None:
        def service(name: str, config: ServiceConfig) -> Service[Any]:
            return Service(name, config, bus.beside(robot), stop)

        self._services = {name: service(name, config) for name, config in configs.items()}
        self._services[NAME] = service(NAME, ServiceConfig())
        whole, negative, positive, fuse = (self._services[name] for name in (NAME, "negative", "positive", "fuse"))
        self._path = topics.DEPTH.key(robot)
        self._decoder = Decoder(DepthImage, whole.metrics, negative.metrics, positive.metrics)
        self._negative = ScanPublishers(negative)
        self._height = RobotHeight(positive)
        self._positive = positive.publisher(topics.SCAN_POSITIVE)
        self._fuser = Fuser(fuse)
        for name, source in fuse.config.inputs.items():
            fuse.receive(topics.scan(source.key), partial(self._fuser.take, name), ROOM)
        self._handover = Handover()
        self.limited = ""  # that not all frames are taken, and how many
        self._publishing = threading.Lock()  # what is decided first leaves first
        whole.receive(OFFERED, self._offered)

    def take(self, payloads: Sequence[bytes]) -> None:
        """Answer the newest good depth image of `payloads`, oldest first, with its scans."""
        images = [image for each in payloads if (image := self._decoder.decode(self._path, each))]
        for _overtaken in images[:-1]:
            self.overtaken()
        for image in images[-1:]:
            if self._handover.frame(image.seq, time.monotonic()):
                self._answer(image)

    def _answer(self, image: DepthImage) -> None:
        settings = Settings(self._services["negative"].config, self._height.config, self._negative.subscribed())
        positive, negative = sense(image, settings)
        self._positive.put(positive)
        self._services["positive"].metrics.output(image.stamp)
        self._negative.publish(negative)
        pair = Pair(positive, negative.combined)
        self._services["fuse"].metrics.count("received", len(pair))
        with self._publishing:
            if self._handover.answer(image.seq):
                self._publish(pair, note="")

    def _offered(self, scan: LaserScan) -> None:
        """A fused scan of the workstation's came, on a thread of its own."""
        with self._publishing:
            if self._handover.offer(scan.seq, time.monotonic()):
                self._publish(Pair(scan, scan), THEIRS)

    def _publish(self, pair: Pair, note: str) -> None:
        """The frame's scan with the robot's extra inputs, whoever perceived the frame."""
        if self._fuser.publish(pair):
            self._services[NAME].metrics.output(pair.positive.stamp)
        self._services[NAME].note = "; ".join(filter(None, (self._services["fuse"].note or note, self.limited)))

    def overtaken(self) -> None:
        """A depth image made room for a newer one."""
        self._decoder.count("overtaken")

    def not_taken(self) -> None:
        """A depth image was dropped as it came, for there is no time for all."""
        self._services[NAME].metrics.count("not_taken")

    def refused(self, why: MessageError) -> None:
        """A depth image was malformed."""
        self._decoder.refused(self._path, why)

    def announce(self) -> None:
        """Hold the tokens."""
        for service in self._services.values():
            service.announce()

    def publish_statuses(self) -> None:
        """Publish how each of the services fares."""
        for service in self._services.values():
            service.publish_status()

    def retract(self) -> None:
        """Take back all that was declared for the robot, the token of perception last."""
        for service in self._services.values():
            service.bus.retract()
