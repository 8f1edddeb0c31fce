"""What a program on one host receives: python -m benchmarks.link.probe --robot NAME --connect ENDPOINT [--drive].

It writes one JSON map when it is told to end: of each key, the stamps [ns] of what came and when [ns] it came; of
base/safety, when which rule held.
"""

import argparse
import json
import time

from cliffscan.common.contract import topics
from cliffscan.common.contract.base_messages import SafetyState, Velocity
from cliffscan.common.contract.message import unpack
from cliffscan.common.runtime import options
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.service import connect
from cliffscan.common.runtime.stop_signal import StopSignal

STAMPED = topics.SCAN_FUSED, topics.ODOMETRY
LARGE = 1 << 20  # [bytes] more than a scan has
PERIOD = 0.1  # [s] between two commands
CIRCLE = 0.1, 0.3  # [m/s], [rad/s]: the robot stays where it is, and what it sees changes


class Record:
    """All that came."""

    def __init__(self, bus: Bus) -> None:
        self.came: dict[str, list[tuple[int, int]]] = {topic.path: [] for topic in STAMPED}
        self.rules: list[tuple[int, str]] = []
        for topic in STAMPED:
            bus.subscribe(topic.path, self._stamped)
        bus.subscribe(topics.SAFETY.path, self._rule)

    def _stamped(self, path: str, payload: bytes) -> None:
        self.came[path].append((unpack(payload, LARGE)["stamp"], time.time_ns()))

    def _rule(self, _: str, payload: bytes) -> None:
        self.rules.append((time.time_ns(), SafetyState.decode(payload).rule))


def main() -> None:
    """Receive until told to end."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.link.probe", description=__doc__)
    options.add_network(parser)
    parser.add_argument("--drive", action="store_true", help="drive in a circle meanwhile")
    arguments = parser.parse_args()
    stop = StopSignal()
    bus = connect(options.network(arguments), arguments.robot, stop)
    if bus is None:
        return
    with bus:
        record = Record(bus)
        velocity = bus.publisher(topics.VELOCITY)
        while not stop.wait(PERIOD):
            if arguments.drive:
                linear, angular = CIRCLE
                velocity.put(Velocity(stamp=time.time_ns(), linear=linear, angular=angular, source="probe"))
    print(json.dumps({**record.came, topics.SAFETY.path: record.rules}), flush=True)


if __name__ == "__main__":
    main()
