"""What is received of a robot within a few seconds: streams, statuses, clocks, descriptions and floors."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from pydantic import TypeAdapter

from cliffscan.clocks import Clocks
from cliffscan.common.contract.camera import FloorPlane
from cliffscan.common.contract.description import BodyDescription, CameraDescription, RobotDescription
from cliffscan.common.contract.message import MessageError, Stamp, unpack
from cliffscan.common.contract.messages import ServiceStatus
from cliffscan.common.contract.topics import (
    DEPTH,
    DESCRIPTION,
    ODOMETRY,
    SCAN_FUSED,
    SCAN_NEGATIVE,
    SCAN_POSITIVE,
    STATUS,
    most_bytes,
)
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.doctor.stream import Arrival
from cliffscan.health import LastStatus
from cliffscan.parts import KOBUKI

STAMP = TypeAdapter(Stamp)
STREAMS = (DEPTH, SCAN_POSITIVE, SCAN_NEGATIVE, SCAN_FUSED, ODOMETRY)


class Floor(NamedTuple):
    """Where a frame says the floor is, and how long [s] it is from one frame to the next, 0 where that is not known."""

    plane: FloorPlane
    period: float


@dataclass
class Observation:
    """All that was received; by a service's name its ways [ns] to this clock, the quickest, and its rates [Hz]."""

    alive: set[str] = field(default_factory=set)
    statuses: dict[str, LastStatus] = field(default_factory=dict)
    ways: dict[str, int] = field(default_factory=dict)
    rates: dict[str, list[float]] = field(default_factory=dict)
    clocks: Clocks = field(default_factory=Clocks)
    streams: dict[str, list[Arrival]] = field(default_factory=dict)
    floors: list[Floor] = field(default_factory=list)
    camera: CameraDescription | None = None
    body: BodyDescription | None = None
    malformed: set[str] = field(default_factory=set)  # paths
    at: float = 0.0  # [s] by the steady clock, when it ended

    def take(self, path: str, payload: bytes, at: int) -> None:
        """Take in a sample that came at `at` [ns] by this machine's clock."""
        service = path.removeprefix(STATUS.prefix + "/")
        try:
            if path == DESCRIPTION.path:
                self._take_description(RobotDescription.decode(payload))
            elif service != path:
                self._take_status(service, ServiceStatus.decode(payload), at)
            else:
                self._take_sample(path, payload, at)
        except (MessageError, KeyError, TypeError, ValueError, OverflowError):
            self.malformed.add(path)

    def _take_description(self, description: RobotDescription) -> None:
        self.camera = description.camera or self.camera
        self.body = description.body or self.body

    def _take_status(self, service: str, status: ServiceStatus, at: int) -> None:
        self.statuses[service] = LastStatus(status, time.monotonic())
        self.rates.setdefault(service, []).append(status.rate)
        self.clocks.receive(service, status.stamp, at)
        self._take_way(service, at - status.stamp)

    def _take_sample(self, path: str, payload: bytes, at: int) -> None:
        """Only the head of a sample is looked at: what is in it, services have checked."""
        fields = unpack(payload, most_bytes(path))
        stamp = STAMP.validate_python(fields["stamp"], strict=True)
        self.streams.setdefault(path, []).append(Arrival(int(fields.get("seq", -1)), stamp, at, len(payload)))
        if path == DEPTH.path:
            nx, ny, nz, d = map(float, fields["floor"])
            self.floors.append(Floor(FloorPlane(nx, ny, nz, d), float(fields.get("period", 0.0))))
        if path == ODOMETRY.path:
            self._take_way(KOBUKI if KOBUKI in self.statuses else path, at - stamp)

    def _take_way(self, service: str, way: int) -> None:
        self.ways[service] = min(way, self.ways.get(service, way))


def observe(bus: Bus, seconds: float, stop: StopSignal) -> Observation:
    """Receive for `seconds` [s] what a robot publishes; nothing is asked of its base."""
    seen, lock = Observation(), threading.Lock()

    def taken(path: str, payload: bytes) -> None:
        at = time.time_ns()
        with lock:
            seen.take(path, payload, at)

    forget: list[Callable[[], None]] = [bus.subscribe(topic.path, taken) for topic in STREAMS]
    forget.append(bus.subscribe(STATUS.named("*").path, taken))
    bus.receive_latched(DESCRIPTION.path, taken)
    stop.wait(seconds)
    for end in forget:
        end()
    seen.alive, seen.at = bus.alive(), time.monotonic()
    with lock:
        return seen
